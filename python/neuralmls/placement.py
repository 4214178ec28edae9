"""Farthest-point placement: control points spread over a shape, so that nobody starts from an empty file.

After Gonzalez, "Clustering to minimize the maximum intercluster distance", 1985: each next point is the one
farthest from those already there. What differs: the first is the point farthest from the centroid, not any;
the candidates are vertices and samples of the surface by area, so that plain parts get their share too.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from neuralmls import _core
from neuralmls.arrays import as_count, as_points, as_triangles
from neuralmls.errors import ArgumentError

# Points at the most: the candidates have to fit into memory.
MOST = 100_000
SEEDS = 2**64 - 1


def farthest_points(positions: ArrayLike, faces: ArrayLike | None, count: int, *, seed: int = 0) -> NDArray[np.float64]:
    """Return `count` points spread evenly over a shape, the first the one farthest from the centroid.

    Parameters
    ----------
    positions : (n, d) float64, in file coordinates
    faces : (f, 3) integers, or None for a point cloud
        Faces without area are passed over. If none has any, the vertices are taken as a cloud.
    count : int, 1 to 100,000
    seed : int, 0 to 2^64 - 1
        The same seed gives the same points.

    Returns
    -------
    (count, d) float64

    Raises
    ------
    ArgumentError
        `count` is out of its range or more than the shape has distinct places; the positions are no finite points;
        a face names no vertex.

    Examples
    --------
    >>> farthest_points([[0.0, 0.0], [1.0, 0.0], [5.0, 0.0]], None, 2).tolist()
    [[5.0, 0.0], [0.0, 0.0]]
    """
    x = as_points("positions", positions)
    if not len(x):
        raise ArgumentError("positions: expected at least one point, found none")
    number, start = as_count("count", count, 1, MOST), as_count("seed", seed, 0, SEEDS)
    return _core.farthest_points(x, as_indices(faces, len(x)), number, start)


def farthest_of(candidates: ArrayLike, count: int) -> NDArray[np.int64]:
    """Choose points (n, d) spread evenly, the first the one farthest from the centroid.

    Returns
    -------
    (count,) indices; fewer if fewer of the points are distinct

    Raises
    ------
    ArgumentError
        The candidates are no finite points; `count` is no whole number from 0 to 100,000.

    Examples
    --------
    >>> farthest_of([[0.0], [1.0], [5.0]], 2).tolist()
    [2, 0]
    """
    x = as_points("candidates", candidates)
    return _core.farthest_of(x, as_count("count", count, 0, MOST))


def sample_surface(positions: ArrayLike, faces: ArrayLike, count: int, *, seed: int = 0) -> NDArray[np.float64]:
    """Return points of a surface, each place as likely as another.

    Returns
    -------
    (count, d) float64; none if no face has area

    Raises
    ------
    ArgumentError
        The positions are no finite points; a face names none of them; a number is out of its range.

    Examples
    --------
    >>> bool(sample_surface([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]], [[0, 1, 2]], 100).sum(axis=1).max() <= 1.0)
    True
    """
    x = as_points("positions", positions)
    number, start = as_count("count", count, 0, MOST), as_count("seed", seed, 0, SEEDS)
    return _core.sample_surface(x, as_indices(faces, len(x)), number, start)


def as_indices(faces: ArrayLike | None, count: int) -> NDArray[np.uint32]:
    """Triangles as the core takes them, none for a cloud."""
    if faces is None or not np.size(faces):
        return np.empty((0, 3), dtype=np.uint32)
    return np.ascontiguousarray(as_triangles(faces, count), dtype=np.uint32)
