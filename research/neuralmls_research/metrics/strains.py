"""How much each triangle is strained: singular values, symmetric Dirichlet energy, area and edge stretch."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from neuralmls_research.metrics.triangles import Array, Indices, as_surface, edges, normals, sound, weighted_median


@dataclass(frozen=True)
class Strain:
    """How much a surface's triangles are strained; 4, 0 and 0 of a motion that keeps their shapes.

    Attributes
    ----------
    dirichlet_mean, dirichlet_median : float
        Symmetric Dirichlet energy, at least 4; weighted by the area before.
    area_mean, area_median : float
        `|A'/A - 1|` of the triangles' areas, weighted by the area before.
    edge_mean, edge_median : float
        `|l'/l - 1|` of the edges' lengths, weighted by the length before.
    degenerate : int
        Triangles that had no shape before, left out of everything.
    collapsed : int
        Triangles that have none afterwards, left out of the energy, which is infinite there.
    """

    dirichlet_mean: float
    dirichlet_median: float
    area_mean: float
    area_median: float
    edge_mean: float
    edge_median: float
    degenerate: int
    collapsed: int


def singular_values(x: ArrayLike, y: ArrayLike, faces: ArrayLike) -> Array:
    """Return the singular values of the linear map of each triangle's plane.

    With `g`, `h` the Gram matrices of two edges before and after, their squares are the eigenvalues of `g^-1 h`.

    Returns
    -------
    (f, 2) float64, the greater first; NaN for triangles lower than 1e-6 of their longest edge before

    Examples
    --------
    >>> triangle = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]])
    >>> singular_values(triangle, triangle * [3, 0.5, 1], [[0, 1, 2]]).round(6).tolist()
    [[3.0, 0.5]]
    """
    before, after, triangles = as_surface(x, y, faces)
    return _singular_values(before, after, triangles, sound(before, triangles))


def strain(x: ArrayLike, y: ArrayLike, faces: ArrayLike) -> Strain:
    """Return how much the triangles are strained from `x` to `y`.

    The symmetric Dirichlet energy of a triangle is `s1^2 + s2^2 + 1/s1^2 + 1/s2^2` of its singular values.

    Source
    ------
    Smith, Schaefer, "Bijective Parameterization with Free Boundaries", 2015 (the energy).

    Examples
    --------
    >>> triangle = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]])
    >>> found = strain(triangle, 2 * triangle, [[0, 1, 2]])
    >>> round(found.dirichlet_mean, 6), round(found.area_mean, 6), round(found.edge_mean, 6)
    (8.5, 3.0, 1.0)
    """
    before, after, triangles = as_surface(x, y, faces)
    kept = sound(before, triangles)
    triangles = triangles[kept]
    whole = sound(after, triangles)
    area, new_area = (np.linalg.norm(normals(points, triangles), axis=1) for points in (before, after))
    squares = _singular_values(before, after, triangles, whole)[whole] ** 2
    energy = (squares + 1 / squares).sum(axis=1)
    length, new_length = (np.linalg.norm(edges(points, triangles), axis=2).ravel() for points in (before, after))
    return Strain(
        *_mean_and_median(energy, area[whole]),
        *_mean_and_median(abs(new_area / area - 1), area),
        *_mean_and_median(abs(new_length / length - 1), length),
        degenerate=int((~kept).sum()),
        collapsed=int((~whole).sum()),
    )


def _singular_values(x: Array, y: Array, faces: Indices, kept: NDArray[np.bool_]) -> Array:
    values = np.full((len(faces), 2), np.nan)
    old, new = (edges(points, faces[kept])[:, :2] for points in (x, y))
    # The first edge along an axis, in its own length: edges of any size give numbers of a usual one.
    length = np.linalg.norm(old[:, 0], axis=1)
    axis = old[:, 0] / length[:, None]
    along = (old[:, 1] * axis).sum(axis=1)
    height = np.linalg.norm(old[:, 1] - along[:, None] * axis, axis=1)
    u = new[:, 0] / length[:, None]
    v = (new[:, 1] - along[:, None] * u) / height[:, None]
    trace = (u * u).sum(axis=1) + (v * v).sum(axis=1)
    determinant = np.linalg.norm(np.cross(u, v), axis=1)
    # s1 +- s2 from the trace and the determinant: exact where they are equal.
    total, apart = np.sqrt(trace + 2 * determinant), np.sqrt(np.maximum(trace - 2 * determinant, 0.0))
    greater = (total + apart) / 2
    values[kept] = np.stack([greater, np.divide(determinant, greater, out=0 * greater, where=greater > 0)], axis=1)
    return values


def _mean_and_median(values: Array, weights: Array) -> tuple[float, float]:
    mean = float((values * weights).sum() / weights.sum()) if weights.sum() > 0 else float("nan")
    return mean, weighted_median(values, weights)
