"""Flipped triangles, folded space, volume."""

from __future__ import annotations

import numpy as np
import pytest

import neuralmls as nm
from neuralmls_research.metrics import flipped_triangles, folded_places, volume, volume_change


def grid(n: int = 6) -> tuple[np.ndarray, np.ndarray]:
    """A square sheet of n x n squares."""
    x = np.stack([*np.meshgrid(np.arange(n + 1.0), np.arange(n + 1.0)), np.zeros((n + 1, n + 1))], axis=-1)
    corner = (np.arange(n)[:, None] * (n + 1) + np.arange(n)).ravel()
    lower = np.stack([corner, corner + 1, corner + n + 2], axis=1)
    upper = np.stack([corner, corner + n + 2, corner + n + 1], axis=1)
    return x.reshape(-1, 3), np.concatenate([lower, upper])


def dented() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A sheet, and the sheet with two inner vertices pushed beyond their neighbours."""
    x, faces = grid()
    y = x.copy()
    y[24] += [1.3, 0.4, 0]
    y[9] += [1.2, 1.3, 0]
    return x, y, faces


def folded_faces(x, y, faces) -> int:
    """In the plane the truth is the sign of the area."""

    def sign(points):
        a, b, c = (points[faces[:, i], :2] for i in range(3))
        return np.sign((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])

    return int((sign(x) != sign(y)).sum())


def test_folded_triangles_are_counted():
    x, y, faces = dented()
    assert flipped_triangles(x, y, faces).count == folded_faces(x, y, faces) == 3
    assert flipped_triangles(x, x, faces).count == 0


def test_neither_winding_nor_seams_nor_second_sides_matter():
    x, y, faces = dented()
    mixed = faces.copy()
    mixed[::3] = mixed[::3, ::-1]
    assert flipped_triangles(x, y, mixed).count == 3
    apart = np.arange(faces.size).reshape(-1, 3)
    assert flipped_triangles(x[faces.ravel()], y[faces.ravel()], apart).count == 3
    sheet = flipped_triangles(x, y, np.concatenate([faces, faces[:, ::-1]]))
    assert (sheet.count, sheet.left_out) == (3, len(faces))


def test_turning_and_bending_flips_nothing(bumpy):
    x, faces = bumpy
    assert flipped_triangles(x, -x, faces).count == 0  # all of it inside out: no triangle against its neighbours
    sheet, triangles = grid(20)
    angle = sheet[:, 0] / 20 * 2 * np.pi
    rolled = np.stack([np.cos(angle), sheet[:, 1], np.sin(angle)], axis=1)
    assert flipped_triangles(sheet, rolled, triangles).count == 0


def test_triangles_without_shape_or_neighbours_are_left_out(soup):
    x, faces = soup
    assert flipped_triangles(x, x, faces).left_out == 3
    assert flipped_triangles(np.eye(3), np.eye(3), [[0, 1, 2]]).left_out == 1
    assert flipped_triangles(np.eye(3), np.eye(3), np.zeros((0, 3), dtype=int)).count == 0


def test_volume_is_that_of_libigl_wherever_the_shape_lies(bumpy):
    igl = pytest.importorskip("igl")
    x, faces = bumpy
    expected = igl.centroid(x, faces)[1]
    assert volume(x, faces) == pytest.approx(expected)
    assert volume(x + 1e6, faces) == pytest.approx(expected, rel=1e-8)
    assert volume_change(x, x * [1, 1, 1.2], faces) == pytest.approx(0.2)
    assert volume_change(x[:, [1, 0, 2]], x[:, [1, 0, 2]] * 0.5, faces) == pytest.approx(-0.875)  # looking inward


def test_a_soup_is_closed_if_its_places_are_and_a_sheet_is_not(soup):
    x, faces = soup
    assert volume(x[:-6], faces[:-3]) is not None
    assert volume(x[:-6], faces[:-4]) is None
    assert volume_change(x[:-6], x[:-6], faces[:-4]) is None
    assert volume_change(*[grid()[0]] * 2, np.concatenate([grid()[1], grid()[1][:, ::-1]])) is None  # holds nothing


@pytest.mark.parametrize("dimension", [1, 2, 3])
def test_folds_are_where_the_determinant_is_not_positive(dimension):
    x = np.random.default_rng(3).uniform(-1, 1, (200, dimension))

    def over(points):
        return np.concatenate([np.sin(3 * points[:, :1]), points[:, 1:]], axis=1)

    expected = int((np.cos(3 * x[:, 0]) <= 0).sum())
    assert 0 < expected < 200
    assert folded_places(over, x, step=1e-5) == expected
    assert folded_places(lambda points: points, x, step=1e-5) == 0


def test_the_map_of_classic_weights_folds_where_one_control_point_crosses_another():
    p = np.array([[0.0], [1.0]])
    weights = nm.InverseDistanceWeights(p)
    x = np.linspace(-1, 2, 61)[:, None]
    assert folded_places(lambda z: nm.Deformer(z, weights).deform([[1.0], [0.0]]), x, step=1e-4) > 10


def test_a_map_that_gives_something_else_is_refused():
    with pytest.raises(nm.ArgumentError, match="expected 2 points, found 1"):
        folded_places(lambda x: x[:1], [[0.0], [1.0]], step=0.1)
    with pytest.raises(nm.ArgumentError, match="step"):
        folded_places(lambda x: x, [[0.0]], step=0)
