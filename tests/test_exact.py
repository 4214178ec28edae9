"""Exact handles: on the user study's cases they arrive, and soft handles are where adherence starts."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import neuralmls as nm
from neuralmls.protocol import Transform

CASES = ["ShapeNetChair1", "ShapeNetChair3", "ShapeNetPlane1", "ShapeNetPlane2"]


@pytest.mark.parametrize("transform", ["rigid", "similarity", "affine"])
@pytest.mark.parametrize("name", CASES)
def test_the_handles_of_the_user_study_arrive(data: Path, name: str, transform: Transform) -> None:
    shape = nm.read(data / "shapenet" / name / "model.obj")
    case = json.loads((data / "shapenet" / "control_points.json").read_text())[name]
    half, centre = np.ptp(shape.bounds, axis=0).max() / 2, shape.bounds.mean(axis=0)
    p = np.array(case["control_points"]) * half + centre
    weights = nm.NeuralWeights.fit(p, bounds=shape.bounds, steps=48)
    handles, exact = nm.Deformer(p, weights, transform=transform), nm.ExactHandles(weights, transform=transform)
    for offsets in case["offsets"].values():
        q = p + np.array(offsets) * half
        aim = exact.aim(q)
        assert np.abs(handles.deform(q, adherence=1.0) - q).max() < 1e-6 * 2 * half
        assert aim.misses.max() < 1e-6 * 2 * half
        np.testing.assert_array_equal(handles.deform(aim.targets), handles.deform(q, adherence=1.0))


def test_one_call_takes_control_points_all_the_way() -> None:
    p = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    q = p + np.array([[0.0, 0.0, 0.1], [0.1, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, -0.1, 0.0]])
    assert np.abs(nm.deform(p, p, q) - q).max() > 1e-3
    assert np.abs(nm.deform(p, p, q, exact=True) - q).max() < 1e-9


def test_wrong_arguments_are_refused_in_a_sentence() -> None:
    exact = nm.ExactHandles(nm.InverseDistanceWeights([[0.0], [1.0]]))
    with pytest.raises(nm.ArgumentError, match="adherence: expected 0 to 1, found 2"):
        exact.aim([[0.0], [1.0]], adherence=2.0)
    with pytest.raises(nm.ArgumentError, match="targets: expected 2 of them, found 1"):
        exact.aim([[0.0]])
    with pytest.raises(nm.ArgumentError, match="temperature"):
        exact.aim([[0.0], [1.0]], temperature=0)
    with pytest.raises(nm.ArgumentError, match="weights"):
        nm.ExactHandles("neural")  # type: ignore[arg-type]
