"""Farthest-point placement: control points spread over a shape, so that nobody starts from an empty file.

After Gonzalez, "Clustering to minimize the maximum intercluster distance", 1985: each next point is the one
farthest from those already there. What differs: the first is the point farthest from the centroid, not any;
the candidates are vertices and samples of the surface by area, so that plain parts get their share too.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from neuralmls.arrays import as_count, as_points
from neuralmls.errors import ArgumentError

# Candidates of each kind, as a minimum and for each control point: enough that more of them move no point by
# more than about a hundredth of the shape.
LEAST = 20_000
EACH = 50
# Points at the most: the candidates have to fit into memory.
MOST = 100_000


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
    as_count("count", count, 1, MOST)
    as_count("seed", seed, 0, 2**64 - 1)
    rng = np.random.default_rng(seed)
    origin = (x.min(axis=0) + x.max(axis=0)) / 2  # samples keep their digits far from the origin
    size = max(LEAST, EACH * count)
    cloud, on_surface = x, np.empty((0, x.shape[1]))
    if faces is not None and np.size(faces):
        cloud, on_surface = sample_faces(x - origin, np.asarray(faces), size, rng)
        cloud = cloud + origin
    few = cloud if len(cloud) <= size else cloud[rng.permutation(len(cloud))[:size]]
    candidates = np.concatenate([few, on_surface + origin])
    chosen = farthest_of(candidates, count)
    if len(chosen) < count and len(few) < len(cloud):  # the subsample had too few distinct places
        candidates = np.unique(cloud, axis=0)
        chosen = farthest_of(candidates, count)
    if len(chosen) < count:
        most = f"{len(chosen)}, the number of distinct places of the shape"
        raise ArgumentError(f"expected a count of at most {most}, found {count}")
    return candidates[chosen]


def sample_faces(
    x: NDArray[np.float64], faces: NDArray[np.int64], size: int, rng: np.random.Generator
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the vertices of the faces (f, 3) that have area, and `size` samples of them; `x` and none without area."""
    if faces.min() < 0 or faces.max() >= len(x):
        raise ArgumentError(f"expected faces to name vertices 0 to {len(x) - 1}, found {faces.min()} to {faces.max()}")
    corner, u, v = x[faces[:, 0]], x[faces[:, 1]] - x[faces[:, 0]], x[faces[:, 2]] - x[faces[:, 0]]
    scale = max(float(np.abs(u).max()), float(np.abs(v).max())) or 1.0  # squares neither over- nor underflow
    uu, vv, uv = (np.einsum("ij,ij->i", a / scale, b / scale) for a, b in ((u, u), (v, v), (u, v)))
    area = np.sqrt(np.maximum(uu * vv - uv * uv, 0.0))
    total = float(area.sum())
    if not total > 0.0:
        return x, np.empty((0, x.shape[1]))
    chosen = np.searchsorted(np.cumsum(area), rng.random(size) * total).clip(max=len(area) - 1)
    s, t = rng.random((2, size, 1))
    s, t = np.where(s + t > 1.0, 1.0 - s, s), np.where(s + t > 1.0, 1.0 - t, t)
    samples = corner[chosen] + s * u[chosen] + t * v[chosen]
    return x[np.unique(faces[area > 0.0])], samples


def farthest_of(candidates: NDArray[np.float64], count: int) -> NDArray[np.int64]:
    """Choose points (n, d) spread evenly, the first the one farthest from the centroid.

    Returns
    -------
    (count,) indices; fewer if fewer of the points are distinct

    Examples
    --------
    >>> farthest_of(np.array([[0.0], [1.0], [5.0]]), 2).tolist()
    [2, 0]
    """
    centred = candidates - candidates.mean(axis=0)
    scale = float(np.abs(centred).max()) or 1.0
    centred /= scale
    distance = np.full(len(centred), np.inf)
    far = int(np.einsum("ij,ij->i", centred, centred).argmax())
    chosen: list[int] = []
    while len(chosen) < count and distance[far] > 0.0:
        chosen.append(far)
        away = centred - centred[far]
        np.minimum(distance, np.einsum("ij,ij->i", away, away), out=distance)
        far = int(distance.argmax())
    return np.array(chosen, dtype=np.int64)
