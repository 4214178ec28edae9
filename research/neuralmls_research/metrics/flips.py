"""Triangles that turn over against their neighbours."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from neuralmls_research.metrics.triangles import Array, Indices, as_surface, normals, places, sound, sum_at


@dataclass(frozen=True)
class Flips:
    """Triangles that turned over against their neighbours.

    Attributes
    ----------
    count : int
    left_out : int
        Triangles without shape before or after, without neighbours, and all but one of those with the same corners
        (the other side of a sheet).
    """

    count: int
    left_out: int


def flipped_triangles(x: ArrayLike, y: ArrayLike, faces: ArrayLike) -> Flips:
    """Count the triangles that turn over against the neighbours across their edges.

    Every triangle looks at the triangles that have an edge in common with it, corners in one place before taken as
    one, each turned so that it looks the same way before, whatever the winding in the file. It has flipped if
    afterwards the sum of `n_t . n_s` over these neighbours is negative; `n` are normals as long as the areas.

    Examples
    --------
    >>> fan = np.array([[0, 0, 0], [3, 0, 0], [0, 3, 0], [-3, -3, 0], [1, 1, 0]])
    >>> folded = np.array([[0, 0, 0], [3, 0, 0], [0, 3, 0], [-3, -3, 0], [2, 2, 0]])
    >>> flipped_triangles(fan, folded, [[0, 1, 4], [1, 2, 4], [2, 0, 4], [0, 2, 3], [0, 3, 1]])
    Flips(count=1, left_out=0)
    """
    before, after, triangles = as_surface(x, y, faces)
    kept = np.flatnonzero(sound(before, triangles) & sound(after, triangles))
    corners = places(before)[triangles]
    _, first = np.unique(np.sort(corners[kept], axis=1), axis=0, return_index=True)
    kept = kept[first]
    edge = _edge_numbers(corners[kept], len(before))
    old, new = (normals(points, triangles[kept]) for points in (before, after))
    ways = _ways(old, edge)
    agreed, agrees = (_agreement(normal, edge, ways) for normal in (old, new))
    counted = agreed > 0
    return Flips(int((counted & (agrees < 0)).sum()), len(triangles) - int(counted.sum()))


def _edge_numbers(corners: Indices, count: int) -> Indices:
    """The number of each triangle's edge between two places, (f, 3); the same for an edge in common."""
    ends = np.sort(np.stack([corners[:, [1, 2, 0]], corners[:, [2, 0, 1]]], axis=2), axis=2)
    _, number = np.unique(ends[..., 0] * count + ends[..., 1], return_inverse=True)
    numbers: Indices = number.reshape(corners.shape).astype(np.int64)
    return numbers


def _ways(normal: Array, edge: Indices) -> Array:
    """1 or -1 for each triangle at each of its edges: whether it looks the same way as the edge's first, (f, 3)."""
    numbers, first = np.unique(edge, return_index=True)
    leader = np.empty(len(numbers), dtype=np.int64)
    leader[numbers] = first // 3
    same: NDArray[np.bool_] = (normal[leader[edge]] * normal[:, None]).sum(axis=2) >= 0
    return np.where(same, 1.0, -1.0)


def _agreement(normal: Array, edge: Indices, ways: Array) -> Array:
    """The sum of `n_t . n_s` over the neighbours of each triangle, all turned by `ways`, (f,)."""
    turned = ways[:, :, None] * normal[:, None]
    others = sum_at(edge, turned, int(edge.max(initial=-1)) + 1)[edge] - turned
    total: Array = (turned * others).sum(axis=(1, 2))
    return total
