"""What turns over: triangles against their surroundings, places where space folds, and what volume is lost."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from neuralmls.arrays import as_number, as_points
from neuralmls.errors import ArgumentError
from neuralmls.metrics.triangles import Array, Indices, as_surface, as_triangles, normals, places, sound, sum_at

# Where less than this part of the normals around a place is left when they are added up, they point nowhere.
CANCELLED = 1e-3


@dataclass(frozen=True)
class Flips:
    """Triangles that turned over against their surroundings.

    Attributes
    ----------
    count : int
    left_out : int
        Triangles without shape before or after, and those whose surroundings have no side: the two faces of a sheet.
    """

    count: int
    left_out: int


def flipped_triangles(x: ArrayLike, y: ArrayLike, faces: ArrayLike) -> Flips:
    """Count the triangles that turn over against their surroundings.

    A triangle's surroundings look where the area-weighted normals of all triangles at its corners add up to; corners
    in one place before count as one. A triangle has flipped if its normal and that of its surroundings were less
    than a right angle apart before and are more than one apart afterwards.

    Parameters
    ----------
    x, y : (n, 3), before and after
    faces : (f, 3) integers

    Raises
    ------
    ArgumentError
        The arrays are no such arrays, or do not fit each other.

    Examples
    --------
    >>> fan = np.array([[0, 0, 0], [3, 0, 0], [0, 3, 0], [-3, -3, 0], [1, 1, 0]])
    >>> folded = np.array([[0, 0, 0], [3, 0, 0], [0, 3, 0], [-3, -3, 0], [2, 2, 0]])
    >>> triangles = [[0, 1, 4], [1, 2, 4], [2, 0, 4], [0, 2, 3], [0, 3, 1]]
    >>> flipped_triangles(fan, folded, triangles).count
    1
    """
    before, after, triangles = as_surface(x, y, faces)
    corners = places(before)[triangles]
    inward = []
    valid = sound(before, triangles) & sound(after, triangles)
    for points in (before, after):
        normal = normals(points, triangles)
        area = np.linalg.norm(normal, axis=1)
        each = np.concatenate([normal, area[:, None]], axis=1)
        around = sum_at(corners, np.repeat(each[:, None], 3, axis=1), len(before))[corners].sum(axis=1)
        valid &= np.linalg.norm(around[:, :3], axis=1) > CANCELLED * around[:, 3]
        inward.append((normal * around[:, :3]).sum(axis=1))
    flipped = valid & (inward[0] > 0) & (inward[1] < 0)
    return Flips(int(flipped.sum()), int((~valid).sum()))


def volume(x: ArrayLike, faces: ArrayLike) -> float | None:
    """Return the volume that a closed surface holds, `sum a . (b x c) / 6`; None if it is not closed.

    It is closed if, vertices in one place taken as one, every edge is walked as often one way as the other.

    Parameters
    ----------
    x : (n, 3), in any units
    faces : (f, 3) integers

    Returns
    -------
    float, cubic units of `x`, negative if the triangles look inward; or None

    Raises
    ------
    ArgumentError
        The arrays are no such arrays.

    Examples
    --------
    >>> corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    >>> round(volume(corners, [[0, 2, 1], [0, 3, 2], [0, 1, 3], [1, 2, 3]]), 4)
    0.1667
    >>> volume(corners, [[0, 2, 1]]) is None
    True
    """
    points = as_points("x", x, 3)
    triangles = as_triangles(faces, len(points))
    return _volume(points, triangles) if _is_closed(points, triangles) else None


def volume_change(x: ArrayLike, y: ArrayLike, faces: ArrayLike) -> float | None:
    """Return by which part the volume of a closed surface changes, `V(y) / V(x) - 1`.

    None if it is not closed before (see `volume`), or holds nothing. Examples and errors as there.

    Examples
    --------
    >>> corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    >>> volume_change(corners, corners * [1, 1, 1.5], [[0, 2, 1], [0, 3, 2], [0, 1, 3], [1, 2, 3]])
    0.5
    """
    before, after, triangles = as_surface(x, y, faces)
    old = _volume(before, triangles)
    size = float(np.ptp(before, axis=0).max(initial=0.0)) if len(before) else 0.0
    if not _is_closed(before, triangles) or not abs(old) > 1e-12 * size**3:
        return None
    return _volume(after, triangles) / old - 1


def folded_places(f: Callable[[Array], Array], x: ArrayLike, *, step: float) -> int:
    """Count the places where a map of space turns it inside out: `det(Jacobian of f) <= 0`.

    The Jacobian is the true one of the map, by central differences, not only the local map `M` of moving least
    squares, which leaves out how the weights change.

    Parameters
    ----------
    f : callable, (n, d) -> (n, d)
    x : (n, d), where to look
    step : float > 0, in units of `x`
        Half of the distance between two points that are compared.

    Raises
    ------
    ArgumentError
        `x` does not hold finite points, the step is not above 0, or `f` gives something else.

    Examples
    --------
    >>> folded_places(lambda x: np.abs(x), [[1.0], [-1.0]], step=1e-3)
    1
    """
    points = as_points("x", x)
    h = as_number("step", step, 0)
    columns = []
    for axis in range(points.shape[1]):
        shift = np.zeros(points.shape[1])
        shift[axis] = h
        ends = [as_points("f(x)", f(points + way * shift), points.shape[1]) for way in (1, -1)]
        if len(ends[0]) != len(points):
            raise ArgumentError(f"f(x): expected {len(points)} points, found {len(ends[0])}")
        columns.append((ends[0] - ends[1]) / (2 * h))
    return int((np.linalg.det(np.stack(columns, axis=2)) <= 0).sum())


def _volume(x: Array, faces: Indices) -> float:
    if not len(faces):
        return 0.0
    near = x - x.mean(axis=0)  # far from the origin, the sum would lose its digits
    return float((near[faces[:, 0]] * np.cross(near[faces[:, 1]], near[faces[:, 2]])).sum() / 6)


def _is_closed(x: Array, faces: Indices) -> bool:
    if not len(faces):
        return False
    corners = places(x)[faces]
    edge = np.concatenate([corners[:, [0, 1]], corners[:, [1, 2]], corners[:, [2, 0]]])
    edge = edge[edge[:, 0] != edge[:, 1]]
    _, index = np.unique(np.sort(edge, axis=1), axis=0, return_inverse=True)
    way = np.where(edge[:, 0] < edge[:, 1], 1.0, -1.0)
    return bool(len(edge)) and not np.bincount(index.reshape(-1), way).any()
