"""What all measures of a surface need: checked arrays, triangles without area, vertices in one place."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from neuralmls.errors import ArgumentError
from neuralmls.plugin import as_points, as_triangles

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

# A triangle lower than this part of its longest edge has no shape to measure: single-precision files hold no more.
THIN = 1e-6


def as_surface(x: ArrayLike, y: ArrayLike, faces: ArrayLike) -> tuple[Array, Array, Indices]:
    """Return a surface's vertices before and after, (n, 3), and its triangles (f, 3).

    Raises
    ------
    ArgumentError
        They are no such arrays, or there are not as many vertices after as before.
    """
    before, after = as_points("x", x, 3), as_points("y", y, 3)
    if len(after) != len(before):
        raise ArgumentError(f"y: expected as many vertices as in x, {len(before)}, found {len(after)}")
    return before, after, as_triangles(faces, len(before))


def normals(x: Array, faces: Indices) -> Array:
    """The triangles' normals, twice as long as their areas are large, (f, 3)."""
    a, b, c = (x[faces[:, corner]] for corner in range(3))
    return np.cross(b - a, c - a)


def edges(x: Array, faces: Indices) -> Array:
    """The vectors of the triangles' edges, each opposite to its corner, (f, 3 corners, 3)."""
    return np.stack([x[faces[:, (i + 2) % 3]] - x[faces[:, (i + 1) % 3]] for i in range(3)], axis=1)


def sound(x: Array, faces: Indices) -> NDArray[np.bool_]:
    """Which triangles are higher than `THIN` of their longest edge, (f,)."""
    longest = (edges(x, faces) ** 2).sum(axis=2).max(axis=1, initial=0.0)
    enough: NDArray[np.bool_] = np.linalg.norm(normals(x, faces), axis=1) > THIN * longest
    return enough


def sum_at(indices: Indices, values: Array, count: int) -> Array:
    """The sums of the rows of `values` that have the same index, (count, columns)."""
    flat = indices.ravel()
    return np.stack([np.bincount(flat, column.ravel(), count) for column in np.moveaxis(values, -1, 0)], axis=-1)


def places(x: Array) -> Indices:
    """The number of each vertex's place: the same for vertices with the same coordinates, (n,)."""
    _, place = np.unique(x + 0.0, axis=0, return_inverse=True)
    return place.reshape(-1).astype(np.int64)


def weighted_median(values: Array, weights: Array) -> float:
    """The value below which half of the weight lies; NaN of nothing."""
    if not len(values) or not weights.sum() > 0:
        return float("nan")
    order = values.argsort()
    below = np.cumsum(weights[order])
    return float(values[order][np.searchsorted(below, below[-1] / 2)])
