"""Farthest-point placement: control points spread over a shape, so that nobody starts from an empty file.

After Gonzalez, "Clustering to minimize the maximum intercluster distance", 1985: each next point is the one
farthest from those already there. What differs: the first is the point farthest from the centroid, not any;
the candidates are vertices and samples of the surface by area, so that plain parts get their share too.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from neuralmls import _core
from neuralmls.arrays import as_count, as_points, as_triangles
from neuralmls.control_points import ControlPoints
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


@dataclass(frozen=True, eq=False)
class MirrorPlane:
    """A plane by which a shape may be its own mirror image: `normal . x = offset`.

    Attributes
    ----------
    normal : (d,) float64, of length 1, its largest component positive
    offset : float
    score : float
        How far mirrored places are from the shape, in what places of it are from each other anyway: 1 is as good as
        can be.
    matched : float
        The part of the shape, 0 to 1, that is met by what is mirrored.
    verdict : str
        "symmetric" (a score of at most 1.3, and 95 % matched), "nearly" (at most 1.95, and 85 %), or "no".
    """

    normal: NDArray[np.float64]
    offset: float
    score: float
    matched: float
    verdict: str

    @classmethod
    def _of(cls, core: tuple[tuple[float, float, float], float, float, float, str], dimension: int) -> Self:
        normal, offset, score, matched, verdict = core
        return cls(np.array(normal[:dimension]), offset, score, matched, verdict)

    def image(self, points: ArrayLike) -> NDArray[np.float64]:
        """Return the mirror images of points (n, d): `x - 2 (n . x - o) n`."""
        x = as_points("points", points, len(self.normal))
        return x - 2 * (x @ self.normal - self.offset)[:, None] * self.normal


@dataclass(frozen=True, eq=False)
class Placed:
    """Control points for a shape.

    Attributes
    ----------
    points : ControlPoints
        p1, p2, ...; of pairs p1.L, p1.R, ...: `.L` is on the side to which the plane's normal points.
    plane : MirrorPlane or None
        By which they are in pairs.
    curve : list of (int, float)
        Where the number was found: for each number the mean distance along the shape to the nearest control point, in
        parts of the shape's longest side.
    """

    points: ControlPoints
    plane: MirrorPlane | None
    curve: list[tuple[int, float]]


def place(
    positions: ArrayLike,
    faces: ArrayLike | None = None,
    count: int | None = None,
    *,
    symmetric: bool = False,
    seed: int = 0,
) -> Placed:
    """Place control points where a person would: at the ends of a shape, and in the middles of its parts.

    Ends are where the mean distance along the shape to all of it is greatest (feet, wing tips); they are at most two
    thirds of the points. The others make `sum_i area_i min_j distance(i, j)` small, along the shape too. What is inside
    of other parts, as the end of a wing in a fuselage, does not count.

    Parameters
    ----------
    positions : (n, d) float64, in file coordinates
    faces : (f, 3) integers, or None for a point cloud
    count : int, 1 to 100,000, optional
        Without it, as many as make much of a difference. More than 128 are spread by `farthest_points`.
    symmetric : bool
        In exact pairs: the shape has to be symmetric (`symmetry`).
    seed : int, 0 to 2^64 - 1
        The same seed gives the same points.

    Returns
    -------
    Placed

    Raises
    ------
    ArgumentError
        `count` is out of its range or more than the shape has places; the shape is not symmetric, where it has to be;
        the positions are no finite points; a face names no vertex.

    Examples
    --------
    >>> bar = [[x, y, 0.0] for x in range(11) for y in range(2)]
    >>> sorted(place(bar, count=3).points.sources[:, 0].tolist())
    [0.0, 5.0, 10.0]
    """
    x = as_points("positions", positions)
    if not len(x):
        raise ArgumentError("positions: expected at least one point, found none")
    number = None if count is None else as_count("count", count, 1, MOST)
    start = as_count("seed", seed, 0, SEEDS)
    core, plane, curve = _core.place_points(x, as_indices(faces, len(x)), number, symmetric, start)
    used = None if plane is None else MirrorPlane._of(plane, x.shape[1])
    return Placed(ControlPoints._of(core), used, curve)


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
