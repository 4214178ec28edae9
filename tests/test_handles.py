"""Exact handles in one call, and arguments that make no sense."""

from __future__ import annotations

import numpy as np
import pytest

import neuralmls as nm


def test_one_call_takes_control_points_all_the_way() -> None:
    p = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    q = p + np.array([[0.0, 0.0, 0.1], [0.1, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, -0.1, 0.0]])
    assert np.abs(nm.deform(p, p, q, handles="soft") - q).max() > 1e-3
    assert np.abs(nm.deform(p, p, q) - q).max() < 1e-9
    assert np.abs(nm.deform(p, p, q, handles="exact") - q).max() < 1e-9


def test_wrong_arguments_are_refused_in_a_sentence() -> None:
    exact = nm.ExactHandles(nm.InverseDistanceWeights([[0.0], [1.0]]))
    with pytest.raises(nm.ArgumentError, match="adherence: expected a number of at least 0 and at most 1, found 2"):
        exact.aim([[0.0], [1.0]], adherence=2.0)
    with pytest.raises(nm.ArgumentError, match="targets: expected 2 of them, found 1"):
        exact.aim([[0.0]])
    with pytest.raises(nm.ArgumentError, match="temperature"):
        exact.aim([[0.0], [1.0]], temperature=0)
    with pytest.raises(nm.ArgumentError, match="weights"):
        nm.ExactHandles("neural")  # type: ignore[arg-type]
