"""Shape-aware weights: which parts they tell apart and which they keep together, on meshes, soups and clouds."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import neuralmls as nm

BOX_FACES = np.array(
    [
        [0, 1, 3],
        [0, 3, 2],
        [4, 6, 7],
        [4, 7, 5],
        [0, 4, 5],
        [0, 5, 1],
        [2, 3, 7],
        [2, 7, 6],
        [0, 2, 6],
        [0, 6, 4],
        [1, 5, 7],
        [1, 7, 3],
    ]
)


def box(low: Any, high: Any) -> np.ndarray:
    """Eight corners."""
    return np.array([[x, y, z] for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])], float)


def soup(boxes: list[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Boxes as one shape, each a component of its own."""
    faces = [BOX_FACES + 8 * number for number in range(len(boxes))]
    return np.concatenate(boxes), np.concatenate(faces)


def stool() -> tuple[np.ndarray, np.ndarray]:
    """A seat of one box, and two legs that are boxes, side by side, and end inside the seat."""
    seat = box((-1, -0.5, 0.9), (1, 0.5, 1.0))
    return soup([seat, box((-0.16, -0.05, -1), (-0.06, 0.05, 0.95)), box((0.06, -0.05, -1), (0.16, 0.05, 0.95))])


def test_a_moved_leg_leaves_the_leg_beside_it() -> None:
    x, faces = stool()
    p = np.array([[-1, 0, 0.95], [1, 0, 0.95], [0, 0.5, 0.95], [-0.11, 0, -1], [-0.11, 0, 0.6], [0.11, 0, -0.4]])
    q = p + 0
    q[3] += [0, 0.5, 0]  # a leg swings forwards
    kept = np.where((x[:, 0] > 0.05) & (x[:, 0] < 0.2))[0]
    moved = {
        kind: np.linalg.norm(nm.deform(x, p, q, weights=kind, faces=faces, handles="exact") - x, axis=1)[kept].max()
        for kind in ("neural", "shape-aware")
    }
    assert moved["shape-aware"] < 0.5 * moved["neural"]


def test_exact_control_points_arrive() -> None:
    x, faces = stool()
    p = np.array([[-1, 0, 0.95], [1, 0, 0.95], [-0.11, 0, -1], [0.11, 0, -1]])
    q = p + np.array([[0, 0, 0.1], [0, 0, 0], [0, 0.3, 0], [0.2, 0, 0]])
    weights = nm.ShapeAwareWeights.fit(p, x, faces)
    assert np.abs(nm.Deformer(p, weights).deform(q, adherence=1.0) - q).max() < 1e-6


def test_identity_and_rigid_motion() -> None:
    x, faces = stool()
    p = x[[0, 5, 10, 20]]
    assert np.array_equal(nm.deform(x, p, p, weights="shape-aware", faces=faces), x)
    c, s = np.cos(0.4), np.sin(0.4)
    turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    y = nm.deform(x, p, p @ turn.T + 2, weights="shape-aware", faces=faces, handles="exact")
    assert np.abs(y - (x @ turn.T + 2)).max() < 1e-9


def test_one_control_point_translates() -> None:
    x, faces = stool()
    y = nm.deform(x, x[:1], x[:1] + 1, weights="shape-aware", faces=faces)
    assert np.abs(y - (x + 1)).max() < 1e-12


def test_one_seed_gives_one_network() -> None:
    x, faces = stool()
    there, again, other = (nm.ShapeAwareWeights.fit(x[:3], x, faces, seed=seed).logits(x) for seed in (1, 1, 2))
    assert np.array_equal(there, again)
    assert not np.array_equal(there, other)


def test_a_shape_far_from_the_origin_and_of_any_size_has_the_same_weights() -> None:
    x, faces = stool()
    far = x * 1024 + 2**20
    here = nm.softmax(nm.ShapeAwareWeights.fit(x[:3], x, faces).logits(x))
    there = nm.softmax(nm.ShapeAwareWeights.fit(far[:3], far, faces).logits(far))
    assert np.abs(here - there).max() < 0.02


def test_a_saved_network_gives_the_same_logits(tmp_path: Any) -> None:
    x, faces = stool()
    weights = nm.ShapeAwareWeights.fit(x[:3], x, faces)
    weights.save(tmp_path / "weights.npz")
    assert np.array_equal(nm.ShapeAwareWeights.load(tmp_path / "weights.npz").logits(x), weights.logits(x))


@pytest.mark.parametrize(
    ("x", "faces", "says"),
    [
        (np.empty((0, 3)), None, "x: expected at least one point"),
        (box((0, 0, 0), (1, 1, 1)), [[0, 1, 8]], "faces: expected vertices 0 to 7, found 0 to 8"),
        (box((0, 0, 0), (1, 1, 1)), [[0, 1, -1]], "found -1 to 1"),
        (box((0, 0, 0), (1, 1, 1)), [[0.0, 1.0, 2.0]], r"expected an \(f, 3\) array of whole numbers"),
        (box((0, 0, 0), (1, 1, 1)), [[0, 1]], r"expected an \(f, 3\) array of whole numbers"),
    ],
)
def test_refuses_in_one_sentence(x: Any, faces: Any, says: str) -> None:
    with pytest.raises(nm.ArgumentError, match=says):
        nm.ShapeAwareWeights.fit([[0.0, 0, 0], [1, 1, 1]], x, faces)
