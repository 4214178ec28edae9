"""Advice: silent where all is well, and told of each thing that was made bad on purpose."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import neuralmls as nm
from neuralmls.settings import Transform

CASES = ["ShapeNetChair1", "ShapeNetChair3", "ShapeNetPlane1", "ShapeNetPlane2"]
# A bar of 4 x 1 x 1 as a grid of points, and control points along it.
BAR = np.stack(np.meshgrid(np.linspace(-2, 2, 41), *2 * [np.linspace(-0.5, 0.5, 9)]), axis=-1).reshape(-1, 3)
ALONG = np.array([[-2.0, 0, 0], [-0.7, 0.4, 0], [0.7, 0, 0.4], [2, 0, 0]])
BOX = np.stack([BAR.min(axis=0), BAR.max(axis=0)])


@pytest.fixture(scope="module")
def weights() -> nm.NeuralWeights:
    return nm.NeuralWeights.fit(ALONG, bounds=BOX, width=128)


def kinds(found: list[nm.Advice]) -> list[str]:
    return [advice.kind for advice in found]


def moved(index: int, *offset: float) -> np.ndarray:
    q = ALONG.copy()
    q[index] += offset
    return q


@pytest.mark.parametrize("transform", ["rigid", "similarity", "affine"])
@pytest.mark.parametrize("temperature", [0.05, 1.0, 5.0])
@pytest.mark.parametrize("handles", ["soft", "exact"])
@pytest.mark.parametrize("kind", ["neural", "inverse-distance"])
def test_unmoved_and_rigidly_moved_control_points_need_no_advice(
    weights: nm.NeuralWeights, kind: str, transform: Transform, temperature: float, handles: str
) -> None:
    function = weights if kind == "neural" else nm.InverseDistanceWeights(ALONG)
    turn = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])
    for q in (ALONG, ALONG @ turn.T + [5, 6, 7]):
        options = {"transform": transform, "temperature": temperature, "handles": handles}
        assert nm.advise(BAR, None, function, q, **options) == []


def test_one_control_point_needs_no_advice() -> None:
    one = nm.NeuralWeights.fit([[2.0, 0, 0]], bounds=BOX, width=16)
    assert nm.advise(BAR, None, one, [[9.0, 1, 0]]) == []


def test_a_gentle_bend_needs_no_advice(weights: nm.NeuralWeights) -> None:
    assert nm.advise(BAR, None, weights, moved(3, -0.2, 0.6, 0)) == []


def test_handles_that_stop_short_are_named_with_what_takes_them_there(weights: nm.NeuralWeights) -> None:
    short = nm.NeuralWeights.fit(ALONG, bounds=BOX, width=128, steps=20)
    (advice,) = nm.advise(BAR, None, short, moved(3, 0, 1, 0), names=["a", "b", "c", "d"])
    misses = np.linalg.norm(nm.Deformer(ALONG, short).deform(moved(3, 0, 1, 0)) - moved(3, 0, 1, 0), axis=1)
    worst = int(misses.argmax())
    assert advice.kind == "misses"
    assert advice.control_points[0] == "abcd"[worst]
    assert advice.where == tuple(ALONG[worst])
    assert advice.amount == pytest.approx(misses.max())
    assert f"with soft handles: '{'abcd'[worst]}' by" in advice.sentence
    assert "exact handles arrive" in advice.sentence
    assert nm.advise(BAR, None, short, moved(3, 0, 1, 0), handles="exact") == []


def test_targets_that_contradict_each_other_are_said_to() -> None:
    p = np.array([[0.0, 0, 0], [0.01, 0, 0], [0, 2, 0], [1, 2, 1.5]])
    q = np.array([[0.0, 0, 0], [3, 0, 0], [0, 2, 0], [1, 2, 1.5]])
    close = nm.NeuralWeights.fit(p, bounds=[[0, 0, 0], [1, 2, 1.5]], width=32, steps=20)
    advice = nm.advise(p, None, close, q, handles="exact")[0]
    assert advice.kind == "misses"
    assert {"p1", "p2"} & set(advice.control_points[:2])


def test_a_fold_is_found_where_it_is(weights: nm.NeuralWeights) -> None:
    (advice,) = [a for a in nm.advise(BAR, None, weights, moved(2, -1.6, 0, 0), temperature=0.5) if a.kind == "folds"]
    assert 0.002 < advice.amount < 0.6
    assert -1.5 < advice.where[0] < 1.5
    assert set(advice.control_points) <= {"p2", "p3"}
    assert "folded over" in advice.sentence


def test_another_temperature_is_named_with_what_is_found_there(weights: nm.NeuralWeights) -> None:
    q = moved(2, -1, 0, 0)
    sharp, plain = (nm.advise(BAR, None, weights, q, temperature=t)[0] for t in (0.5, 1.0))
    assert (sharp.kind, plain.kind) == ("folds", "folds")
    assert plain.amount <= sharp.amount / 2
    assert f"at temperature 1 it is {100 * plain.amount:.2g} %" in sharp.sentence


def test_no_setting_is_named_where_none_helps(weights: nm.NeuralWeights) -> None:
    q = moved(2, -1.6, 0, 0)
    folded = [nm.advise(BAR, None, weights, q, temperature=t)[0] for t in (0.125, 0.25, 0.5, 1.0)]
    assert all(other.amount > folded[1].amount / 2 for other in folded)
    assert "move the control points there less far" in folded[1].sentence


@pytest.mark.parametrize("temperature", [0.05, 0.01])
def test_parts_torn_between_far_control_points_are_found(weights: nm.NeuralWeights, temperature: float) -> None:
    found = nm.advise(BAR, None, weights, moved(3, 2, 0, 0), temperature=temperature)
    (advice,) = [advice for advice in found if advice.kind == "torn"]
    assert set(advice.control_points) == {"p3", "p4"}
    assert 0.7 < advice.where[0] < 2
    assert advice.amount > 4


def test_a_part_far_from_all_control_points_is_found() -> None:
    p = np.array([[-2.0, 0, 0], [-1.7, 0.4, 0], [-1.7, 0, 0.4], [-1.4, 0, 0]])
    end = nm.NeuralWeights.fit(p, bounds=BOX, width=128)
    q = p + np.array([[0.0, 0, 0], [0, 0.1, 0], [0, 0, 0], [0, 0.3, 0]])
    (advice,) = [advice for advice in nm.advise(BAR, None, end, q) if advice.kind == "ungoverned"]
    assert advice.where[0] == 2.0
    assert advice.amount == pytest.approx(np.linalg.norm(np.array(advice.where) - p, axis=1).min())
    assert "put a control point there" in advice.sentence


def test_faces_are_looked_at_by_area() -> None:
    """Eight corners are all that the box's vertices are: the fold lies between them."""
    corners = np.array([[x, y, z] for x in (-2.0, 2) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
    quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    faces = np.array([[q[0], q[i], q[i + 1]] for q in quads for i in (1, 2)])
    middle = nm.NeuralWeights.fit(ALONG, bounds=BOX, width=128)
    options = {"temperature": 0.5}
    assert "folds" in kinds(nm.advise(corners, faces, middle, moved(2, -1.6, 0, 0), **options))
    assert "folds" not in kinds(nm.advise(corners, None, middle, moved(2, -1.6, 0, 0), **options))


def test_advice_does_not_depend_on_the_units(weights: nm.NeuralWeights) -> None:
    q, scale, shift = moved(2, -1.6, 0, 0), 1e3, np.array([4e5, 5e6, 100.0])
    small = nm.advise(BAR, None, nm.InverseDistanceWeights(ALONG), q)
    large = nm.advise(BAR * scale + shift, None, nm.InverseDistanceWeights(ALONG * scale + shift), q * scale + shift)
    assert kinds(small) == kinds(large) != []
    assert small[0].amount == pytest.approx(large[0].amount, abs=5e-3)


def test_lines_and_planes_get_advice_too() -> None:
    x = np.random.default_rng(0).uniform(0, 1, (500, 2))
    p = np.array([[0.0, 0], [1, 0], [0, 1], [1, 1], [0.4, 0.5], [0.6, 0.5]])
    q = p.copy()
    q[[4, 5]] = [[0.9, 0.5], [0.1, 0.5]]
    assert "folds" in kinds(nm.advise(x, None, nm.InverseDistanceWeights(p), q))


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("handles", ["soft", "exact"])
def test_people_in_the_user_study_would_have_got_little_advice(data: Path, name: str, handles: str) -> None:
    shape = nm.read(data / "shapenet" / name / "model.obj")
    case = json.loads((data / "shapenet" / "control_points.json").read_text())[name]
    half, centre = np.ptp(shape.bounds, axis=0).max() / 2, shape.bounds.mean(axis=0)
    p = np.array(case["control_points"]) * half + centre
    function = nm.NeuralWeights.fit(p, bounds=shape.bounds)
    found = {
        study: kinds(nm.advise(shape.positions, shape.faces, function, p + np.array(o) * half, handles=handles))
        for study, o in case["offsets"].items()
    }
    # Its rear wings are moved through each other.
    expected = {"user_study_3": ["folds"]} if name == "ShapeNetPlane2" else {}
    assert {study: told for study, told in found.items() if told} == expected
    # Three times as far, every shape is told of.
    far = p + 3 * np.array(case["offsets"]["user_study_3"]) * half
    assert kinds(nm.advise(shape.positions, shape.faces, function, far, handles=handles))


def test_wrong_arguments_are_refused_in_a_sentence(weights: nm.NeuralWeights) -> None:
    with pytest.raises(nm.ArgumentError, match="x: expected at least one point"):
        nm.advise(np.empty((0, 3)), None, weights, ALONG)
    with pytest.raises(nm.ArgumentError, match="targets: expected 4 of them, found 3"):
        nm.advise(BAR, None, weights, ALONG[:3])
    with pytest.raises(nm.ArgumentError, match="names: expected 4 of them, found 1"):
        nm.advise(BAR, None, weights, ALONG, names=["a"])
    with pytest.raises(nm.ArgumentError, match="temperature"):
        nm.advise(BAR, None, weights, ALONG, temperature=0)
    with pytest.raises(nm.ArgumentError, match="faces"):
        nm.advise(BAR, [[0, 1, 2**40]], weights, ALONG)
    with pytest.raises(nm.ArgumentError, match="faces: expected an"):
        nm.advise(BAR, [[0.0, 1.0, 2.0]], weights, ALONG)


def test_many_control_points_of_a_smooth_motion_ask_for_affine_maps() -> None:
    p = BAR[nm.farthest_of(BAR, 60)]
    bent = p + 0.2 * np.stack([np.sin(p[:, 1]), np.cos(p[:, 0]), np.sin(p[:, 0])], axis=1) + [0.2, 0, 0] * p
    weights = nm.InverseDistanceWeights(p, alpha=2, bounds=BOX)
    (stiff,) = [advice for advice in nm.advise(BAR, None, weights, bent) if advice.kind == "stiff"]
    assert stiff.sentence.startswith("rigid maps follow these 60 control points worse than affine ones would")
    assert "stiff" not in kinds(nm.advise(BAR, None, weights, bent, transform="affine"))
    # What turns in parts is what rigid maps are for; and few control points say too little.
    sin, cos = np.sin(1.2 * (p[:, 0] > 0)), np.cos(1.2 * (p[:, 0] > 0))
    twisted = np.stack([p[:, 0], cos * p[:, 1] - sin * p[:, 2], sin * p[:, 1] + cos * p[:, 2]], axis=1)
    assert "stiff" not in kinds(nm.advise(BAR, None, weights, twisted))
    few = nm.InverseDistanceWeights(p[:40], alpha=2, bounds=BOX)
    assert "stiff" not in kinds(nm.advise(BAR, None, few, bent[:40]))
