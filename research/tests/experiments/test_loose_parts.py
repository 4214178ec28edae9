"""Parts without a control point go with what they sit on."""

from __future__ import annotations

import numpy as np
import pytest

from neuralmls.errors import NotApplicable
from neuralmls_research.baselines.rigid import moved_rigidly
from neuralmls_research.experiments.loose_parts import with_loose_parts
from neuralmls_research.experiments.methods import METHODS, Surface

pytest.importorskip("igl")

ARAP = METHODS["arap-from-fit"]
BODY = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0.5, 0.5, 0.3]])
EYE = np.array([[0.5, 0.5, 0.31], [0.55, 0.5, 0.31], [0.5, 0.55, 0.31]])
FACES = np.array([[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]])
HEAD = Surface(np.concatenate([EYE, BODY]), np.concatenate([[[0, 1, 2]], FACES + 3]))
TURN = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])


def test_a_rigid_motion_of_the_control_points_takes_a_loose_part_along():
    p = BODY[:4]
    with pytest.raises(NotApplicable, match="1 of 2 have none"):
        ARAP(HEAD, p, p @ TURN.T + 3)
    y = with_loose_parts(ARAP)(HEAD, p, p @ TURN.T + 3)
    np.testing.assert_allclose(y, HEAD.positions @ TURN.T + 3, atol=1e-6)


def test_parts_with_control_points_are_deformed_as_without_the_loose_one():
    p, q = BODY[:4], BODY[:4] * [1.3, 1, 1]
    y = with_loose_parts(ARAP)(HEAD, p, q)
    np.testing.assert_array_equal(y[3:], ARAP(Surface(BODY, FACES), p, q))
    sides = [np.linalg.norm(x[1] - x[0]) for x in (HEAD.positions, y)]
    assert sides[0] == pytest.approx(sides[1])  # it stays as it is


def test_without_loose_parts_and_without_motion_nothing_changes():
    body = Surface(BODY, FACES)
    p, q = BODY[:4], BODY[:4] * [1.3, 1, 1]
    np.testing.assert_array_equal(with_loose_parts(ARAP)(body, p, q), ARAP(body, p, q))
    np.testing.assert_allclose(with_loose_parts(ARAP)(HEAD, p, p), HEAD.positions, atol=1e-15)
    with pytest.raises(NotApplicable, match="cloud of points"):
        with_loose_parts(ARAP)(Surface(BODY, None), p, q)


def test_the_fitted_motion_is_never_a_reflection():
    y = moved_rigidly(BODY, BODY, BODY * [1, 1, -1])
    assert np.linalg.det(np.linalg.lstsq(BODY - BODY.mean(0), y - y.mean(0), rcond=None)[0]) == pytest.approx(1)
