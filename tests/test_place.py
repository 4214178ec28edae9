"""Placed control points: where a person would put them on samples, in exact pairs, and refused with a word."""

import numpy as np
import pytest
from numpy.typing import NDArray

import neuralmls as nm
from neuralmls.errors import ArgumentError
from neuralmls.samples import make
from neuralmls.samples.sample import write_obj

# What a person would take hold of, in the coordinates of the samples.
EXPECTED = {
    "chair": [
        *[(x, 0.0, z) for x in (-0.21, 0.21) for z in (0.2, -0.23)],  # feet
        *[(x, 0.98, -0.27) for x in (-0.19, 0.19)],  # tops of the back
        *[(x, 0.67, 0.19) for x in (-0.22, 0.22)],  # ends of the armrests
    ],
    "airplane": [
        (0.0, -0.25, 11.0),  # nose
        *[(x, 0.9, -3.3) for x in (-10.5, 10.5)],  # wing tips
        *[(x, 1.35, -12.4) for x in (-4.1, 4.1)],  # tailplane
        (0.0, 5.2, -12.8),  # fin
    ],
    "car": [
        *[(x, 0.36, 1.9) for x in (-0.65, 0.65)],  # corners of the bumpers
        *[(x, 0.38, -1.88) for x in (-0.65, 0.65)],
        (0.0, 1.47, -0.6),  # roof
    ],
    "table": [
        *[(x, 0.0, z) for x in (-0.62, 0.62) for z in (-0.27, 0.27)],  # feet
        *[(x, 0.72, z) for x in (-0.7, 0.7) for z in (-0.35, 0.35)],  # corners of the top
    ],
}
NEAR = 0.08  # of the longest side
SHARE = 0.75


def sample(name: str) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    made = make(name)
    return made.vertices, made.triangles


@pytest.mark.parametrize("symmetric", [False, True])
def test_samples_are_held_where_a_person_would(symmetric: bool) -> None:
    off: list[float] = []
    for name, places in EXPECTED.items():
        x, faces = sample(name)
        for count in (12, 16):
            points = nm.place(x, faces, count, symmetric=symmetric).points.sources
            away = np.linalg.norm(points[None] - np.array(places)[:, None], axis=2).min(axis=1)
            off += (away / np.ptp(x, axis=0).max()).tolist()
    near = np.count_nonzero(np.array(off) <= NEAR)
    assert near >= SHARE * len(off), f"{near} of {len(off)}"


def test_pairs_are_exact_named_and_in_the_session_file(tmp_path) -> None:
    x, faces = sample("airplane")
    placed = nm.place(x, faces, 12, symmetric=True)
    points, plane = placed.points, placed.plane
    assert plane is not None
    assert plane.verdict == "symmetric"
    pairs = [(of, name) for name, of in zip(points.names, points.mirror_of, strict=True) if of is not None]
    assert len(pairs) >= 4
    at = dict(zip(points.names, points.sources, strict=True))
    for left, right in pairs:
        assert (left[-2:], right[-2:], left[:-2]) == (".L", ".R", right[:-2])
        assert at[left][0] > 0
        np.testing.assert_array_equal(plane.image(at[left][None])[0], at[right])
    points.write(tmp_path / "points.json")
    assert nm.ControlPoints.read(tmp_path / "points.json").mirror_of == points.mirror_of


def test_symmetry_takes_shapes_and_points(tmp_path) -> None:
    write_obj(make("car"), tmp_path / "car.obj")
    shape = nm.read(tmp_path / "car.obj")
    (best, *_), (again, *_) = nm.symmetry(shape), nm.symmetry(shape.positions, shape.faces)
    assert (best.verdict, best.offset, best.score) == ("symmetric", again.offset, again.score)
    assert abs(best.normal[0]) > 0.9999
    assert nm.symmetry(np.zeros((50, 3))) == []
    with pytest.raises(ArgumentError, match="beside an array"):
        nm.symmetry(shape, shape.faces)


def test_auto_shows_what_each_number_is_worth() -> None:
    x, faces = sample("table")
    placed = nm.place(x, faces)
    counts, far = zip(*placed.curve, strict=True)
    assert len(placed.points) in counts
    assert counts == tuple(range(counts[0], counts[-1] + 1))
    assert far[-1] < far[0] < 1


@pytest.mark.parametrize(
    ("positions", "faces", "wish", "says"),
    [
        (np.zeros((0, 3)), None, {}, "at least one point, found none"),
        (np.eye(3), None, {"count": 0}, "count: expected a whole number from 1 to 100000, found 0"),
        (np.eye(3), None, {"count": 4}, "at most 3, the number of distinct places of the shape, found 4"),
        (np.eye(3), [[0, 1, 3]], {"count": 1}, "vertices 0 to 2, found 0 to 3"),
        (np.eye(3), None, {"count": 2, "symmetric": True}, "symmetric: the shape is not its own mirror image"),
    ],
)
def test_what_cannot_be_placed_is_refused(positions, faces, wish, says) -> None:
    with pytest.raises(ArgumentError, match=says):
        nm.place(positions, faces, **wish)
