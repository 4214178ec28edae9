"""Turned control points through the public functions: laws for any points, weights, rotations and temperatures."""

from __future__ import annotations

import doctest

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import neuralmls as nm

TRANSFORMS = ["rigid", "similarity", "affine"]
TEMPERATURES = st.sampled_from([0.01, 0.02, 0.3, 1.0, 5.0, 100.0])
X = np.random.default_rng(0).uniform(-1, 1, (50, 3))
WHICH = st.lists(st.booleans(), min_size=6, max_size=6)


@pytest.fixture(scope="module", params=["neural", "inverse-distance"])
def weights(request):
    """A weight function of six control points that span the space."""
    p = np.random.default_rng(1).uniform(-1, 1, (6, 3))
    if request.param == "neural":
        return nm.NeuralWeights.fit(p, bounds=[[-1] * 3, [1] * 3], width=128)
    return nm.InverseDistanceWeights(p, alpha=1.5)


@st.composite
def rotations(draw):
    axis = draw(st.tuples(*[st.floats(-1, 1, width=16)] * 3).filter(any))
    return nm.Orientation(axis, draw(st.floats(-180, 180))).matrix


def some(rotation, which):
    """The rotation for some control points, None for the others."""
    return [rotation if turned else None for turned in which]


@pytest.mark.parametrize("transform", TRANSFORMS)
@given(which=WHICH, temperature=TEMPERATURES)
def test_turns_by_nothing_return_the_input_bit_for_bit(weights, transform, which, temperature):
    deformer = nm.Deformer(X, weights, transform=transform)
    scales = [1.0 if turned else None for turned in which]
    y = deformer.deform(weights.control_points, temperature, rotations=some(np.eye(3), which), scales=scales)
    assert y.tobytes() == X.tobytes()


@pytest.mark.parametrize("transform", TRANSFORMS)
@given(rotation=rotations(), which=WHICH, temperature=TEMPERATURES)
def test_a_rigid_motion_of_all_moves_every_point_by_it(weights, transform, rotation, which, temperature):
    move = lambda v: v @ rotation.T + 0.3
    deformer = nm.Deformer(X, weights, transform=transform)
    y = deformer.deform(move(weights.control_points), temperature, rotations=some(rotation, which))
    assert np.abs(y - move(X)).max() < 1e-5


@pytest.mark.parametrize("transform", ["similarity", "affine"])
@given(rotation=rotations(), scale=st.floats(0.1, 4), which=WHICH, temperature=TEMPERATURES)
def test_a_similarity_of_all_moves_every_point_by_it(weights, transform, rotation, scale, which, temperature):
    move = lambda v: scale * v @ rotation.T + 0.3
    y = nm.Deformer(X, weights, transform=transform).deform(
        move(weights.control_points),
        temperature,
        rotations=some(rotation, which),
        scales=[scale if turned else np.nan for turned in which],
    )
    assert np.abs(y - move(X)).max() < 1e-5


@pytest.mark.parametrize("transform", TRANSFORMS)
@given(rotation=rotations(), temperature=TEMPERATURES)
def test_one_control_point_alone_turns_everything_about_it(transform, rotation, temperature):
    weights = nm.InverseDistanceWeights([[0.2, 0.1, 0.3]])
    p = weights.control_points
    y = nm.Deformer(X, weights, transform=transform).deform(p, temperature, rotations=[rotation])
    assert np.abs(y - ((X - p) @ rotation.T + p)).max() < 1e-8


def test_rotations_for_none_give_the_very_bytes_of_before(weights):
    q = weights.control_points + 0.1 * np.sin(np.arange(18.0)).reshape(6, 3)
    for transform in TRANSFORMS:
        deformer = nm.Deformer(X, weights, transform=transform)
        plain = deformer.deform(q)
        for none in ([None] * 6, np.full((6, 3, 3), np.nan)):
            assert deformer.deform(q, rotations=none, scales=[None] * 6).tobytes() == plain.tobytes()


def test_two_control_points_twist_a_bar():
    around = np.linspace(0, 2 * np.pi, 12, endpoint=False)
    bar = np.array([[0.1 * np.cos(a), 0.1 * np.sin(a), h] for h in np.linspace(0, 1, 41) for a in around])
    ends = [[0, 0, 0], [0, 0, 1]]
    turns = [nm.Orientation((0, 0, 1), -50).matrix, nm.Orientation((0, 0, 1), 50).matrix]
    for transform in ("rigid", "similarity"):
        y = nm.deform(bar, ends, ends, rotations=turns, transform=transform)
        assert np.abs(np.hypot(y[:, 0], y[:, 1]) - 0.1).max() < 1e-6  # as thick as it was
        angles = np.degrees(np.arctan2(y[::12, 1], y[::12, 0]))
        assert angles[0] == pytest.approx(-50, abs=1)
        assert angles[-1] == pytest.approx(50, abs=1)
        assert (np.diff(angles) > 0).all()


def test_exact_handles_arrive_turned(weights):
    p = weights.control_points
    q = p + 0.1 * np.cos(np.arange(18.0)).reshape(6, 3)
    turns = some(nm.Orientation((1, 2, 3), 40).matrix, [True, False, False, True, False, False])
    at_handles = nm.Deformer(p, weights)
    soft, exact = (at_handles.deform(q, rotations=turns, adherence=adherence) for adherence in (0, 1))
    if isinstance(weights, nm.NeuralWeights):  # classic handles always arrive
        assert np.abs(soft - q).max() > 1e-3
    assert np.abs(exact - q).max() < 1e-8


def test_the_order_of_the_control_points_does_not_matter():
    rng = np.random.default_rng(2)
    p, q = rng.uniform(-1, 1, (2, 6, 3))
    turns = [
        nm.Orientation(tuple(axis), 50).matrix if i % 2 else None for i, axis in enumerate(rng.normal(size=(6, 3)))
    ]
    order = rng.permutation(6)
    for transform in TRANSFORMS:
        here = nm.deform(X, p, q, rotations=turns, transform=transform)
        there = nm.deform(X, p[order], q[order], rotations=[turns[i] for i in order], transform=transform)
        assert np.abs(here - there).max() < 1e-6


def test_in_the_plane_and_on_a_line():
    corner = nm.deform([[1.0, 0.0]], [[0.0, 0.0]], [[0.0, 0.0]], rotations=[nm.Orientation(degrees=90).rotation(2)])
    assert np.abs(corner - [[0, 1]]).max() < 1e-8
    line = nm.deform([[3.0]], [[1.0]], [[1.0]], scales=[2.0], transform="similarity")
    assert np.abs(line - [[5]]).max() < 1e-8


def test_maps_turn_with_a_turned_control_point(weights):
    turn, p = nm.Orientation((0, 0, 1), 60).matrix, weights.control_points
    _, maps = nm.Deformer(p, weights).deform(p, rotations=[turn, *[None] * 5], return_maps=True)
    assert np.degrees(np.arccos((np.trace(maps[0] @ turn.T) - 1) / 2)) < 10
    assert np.abs(maps @ maps.transpose(0, 2, 1) - np.eye(3)).max() < 1e-9


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"rotations": [np.eye(3)]}, "expected 6 of them, found 1"),
        ({"rotations": [np.diag([1, 1, -1.0])] * 6}, "control point 0 is not a rotation: its determinant is -1"),
        ({"rotations": [None, 1.1 * np.eye(3), *[None] * 4]}, "control point 1 is not a rotation: its columns"),
        ({"rotations": [np.eye(2)] * 6}, r"\(3, 3\), found shape \(2, 2\)"),
        ({"rotations": ["x"] * 6}, "matrix of numbers"),
        ({"rotations": 3}, "one for each control point"),
        ({"scales": [1, 1, 1, 0, 1, 1]}, "above 0 for control point 3, found 0"),
        ({"scales": [1.0]}, "expected 6 of them, found 1"),
    ],
)
def test_what_is_no_turn_is_refused_in_one_sentence(weights, given, words):
    for call in (nm.Deformer(X, weights).deform, nm.ExactHandles(weights).aim):
        with pytest.raises(nm.ArgumentError, match=words):
            call(weights.control_points, **given)


def test_advice_knows_of_turns(weights):
    p = weights.control_points
    quarter = nm.Orientation((0, 0, 1), 90).matrix
    assert nm.advise(X, None, weights, p @ quarter.T, rotations=[quarter] * 6) == []
    wild = some(nm.Orientation((1, 0, 0), 170).matrix, [True, False] * 3)
    assert nm.advise(X, None, weights, p) == []
    assert nm.advise(X, None, weights, p, rotations=wild) != []


def test_the_example_of_orientations_runs():
    """It stands in Rust, where pytest finds no examples."""
    example = doctest.DocTestParser().get_doctest(
        nm.Orientation.__doc__, {"Orientation": nm.Orientation}, "Orientation", None, None
    )
    assert len(example.examples) >= 1
    assert doctest.DocTestRunner().run(example).failed == 0
