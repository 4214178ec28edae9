"""Farthest-point placement: spread evenly, on the surface, deterministic, whatever the shape."""

import time

import numpy as np
import pytest
from numpy.typing import NDArray

from neuralmls.errors import ArgumentError
from neuralmls.placement import farthest_points

SQUARE = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
TWO_FACES = np.array([[0, 1, 2], [0, 2, 3]])


def spacing(points: NDArray[np.float64]) -> float:
    distance = np.linalg.norm(points[:, None] - points[None], axis=2)
    return float(distance[distance > 0].min())


def test_four_points_on_a_square_are_its_corners() -> None:
    points = farthest_points(SQUARE, TWO_FACES, 4)
    assert sorted(map(tuple, points)) == sorted(map(tuple, SQUARE))


def test_points_lie_on_the_surface_and_apart() -> None:
    points = farthest_points(SQUARE, TWO_FACES, 25)
    assert (points[:, 2] == 0).all()
    assert points.min() >= 0
    assert points.max() <= 1
    assert spacing(points) > 0.15  # the best that 25 points on a square can do is 0.25


def test_a_dense_patch_attracts_no_more_points_than_a_plain_one() -> None:
    rng = np.random.default_rng(0)
    patch = rng.random((50_000, 2)) * 0.1
    triples = np.arange(49_998).reshape(-1, 3) + 4
    x = np.concatenate([SQUARE[:, :2], patch])
    points = farthest_points(x, np.concatenate([TWO_FACES, triples]), 100)
    assert np.count_nonzero((points < 0.1).all(axis=1)) <= 4


def test_the_first_is_farthest_from_the_centroid() -> None:
    cloud = np.array([[0.0, 0], [1, 0], [0, 1], [9, 9]])
    assert farthest_points(cloud, None, 1).tolist() == [[9, 9]]


def test_the_same_seed_gives_the_same_points() -> None:
    one, two = (farthest_points(SQUARE, TWO_FACES, 30, seed=3) for _ in range(2))
    assert one.tobytes() == two.tobytes()
    assert farthest_points(SQUARE, TWO_FACES, 30, seed=4).tobytes() != one.tobytes()


def test_far_from_the_origin_points_keep_their_millimetres() -> None:
    offset = np.array([500_000.0, 5_600_000.0, 100.0])
    near, far = farthest_points(SQUARE, TWO_FACES, 10), farthest_points(SQUARE + offset, TWO_FACES, 10)
    assert np.abs(far - offset - near).max() < 1e-8


@pytest.mark.parametrize("size", [1e-200, 1e200])
def test_neither_tiny_nor_huge_shapes_change_the_answer(size: float) -> None:
    near, scaled = farthest_points(SQUARE, TWO_FACES, 10), farthest_points(SQUARE * size, TWO_FACES, 10)
    assert np.allclose(scaled / size, near, rtol=0, atol=1e-12)


def test_degenerate_faces_and_loose_vertices_are_passed_over() -> None:
    x = np.concatenate([SQUARE, [[50.0, 50, 50], [60, 60, 60]]])
    faces = np.concatenate([TWO_FACES, [[4, 4, 5], [5, 5, 5]]])
    assert farthest_points(x, faces, 20).max() <= 1.0


def test_faces_without_any_area_leave_a_cloud() -> None:
    x = np.array([[0.0], [1.0], [5.0]])
    points = farthest_points(x, np.array([[0, 1, 2]]), 3)
    assert sorted(points[:, 0]) == [0, 1, 5]


def test_rare_places_in_a_large_cloud_are_found() -> None:
    cloud = np.zeros((300_000, 3))
    cloud[7], cloud[8] = 1.0, 2.0
    assert len(np.unique(farthest_points(cloud, None, 3), axis=0)) == 3


def test_a_million_vertices_take_seconds() -> None:
    cloud = np.random.default_rng(0).random((1_000_000, 3))
    start = time.process_time()
    points = farthest_points(cloud, None, 64)
    assert time.process_time() - start < 10.0
    assert spacing(points) > 0.2


@pytest.mark.parametrize(
    ("positions", "faces", "count", "says"),
    [
        (SQUARE, TWO_FACES, 0, "count: expected a whole number from 1 to 100000, found 0"),
        (SQUARE, TWO_FACES, 10**12, "count: expected a whole number from 1 to 100000"),
        (SQUARE, TWO_FACES, 2.5, "count: expected a whole number, found 2.5"),
        ([[0.0], [1.0, 2.0]], None, 1, "positions: expected an"),
        (SQUARE, None, 5, "at most 4, the number of distinct places of the shape, found 5"),
        (np.zeros((9, 3)), [[0, 1, 2]], 2, "at most 1,"),
        (SQUARE, [[0, 1, 4]], 2, "vertices 0 to 3, found 0 to 4"),
        (SQUARE, [[0, 1, -1]], 2, "vertices 0 to 3, found -1 to 1"),
        (np.zeros((0, 3)), None, 1, "at least one point, found none"),
        ([[0.0, np.nan, 0.0]], None, 1, "positions: point 0 has a coordinate that is not finite"),
    ],
)
def test_what_cannot_be_placed_is_refused(positions: object, faces: object, count: int, says: str) -> None:
    with pytest.raises(ArgumentError, match=says):
        farthest_points(positions, faces, count)  # type: ignore[arg-type]
