"""How much a surface is bent: the change of the angles between its triangles."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from neuralmls.plugin import as_points, as_triangles
from neuralmls_research.metrics.triangles import Array, Indices, normals, places, sound


class Bends:
    """The angles between the triangles of a surface at rest, found once for any number of deformations.

    Vertices in one place are one, a triangle that is there twice counts once; edges of more than two triangles are left
    out, and those of triangles without shape before or after.

    Parameters
    ----------
    x : (n, 3), vertices at rest, in any units
    faces : (f, 3) integers

    Raises
    ------
    ArgumentError
        They are no such arrays.

    Examples
    --------
    >>> sheet = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    >>> bends = Bends(sheet, [[0, 1, 2], [0, 2, 3]])
    >>> bends.bent(sheet), round(bends.bent(sheet + [[0, 0, 0], [0, 0, 1], [0, 0, 0], [0, 0, 1]]), 3)
    (0.0, 2.702)
    """

    def __init__(self, x: ArrayLike, faces: ArrayLike) -> None:
        rest = as_points("x", x, 3)
        triangles = as_triangles(faces, len(rest))
        triangles = triangles[sound(rest, triangles)]
        place = places(rest)
        self._faces = triangles[_once(np.sort(place[triangles], axis=1))]
        corners = place[self._faces]
        sides = np.concatenate([corners[:, [0, 1]], corners[:, [1, 2]], corners[:, [2, 0]]])
        ends = np.concatenate([self._faces[:, [0, 1]], self._faces[:, [1, 2]], self._faces[:, [2, 0]]])
        first, second = _pairs(sides)
        self._pair = np.stack([first, second], axis=1) % max(len(corners), 1)
        self._ends = ends[first]
        # The other triangle's normal is turned over where both walk the edge the same way.
        self._way = np.where(sides[first, 0] == sides[second, 0], -1.0, 1.0)
        self._length = np.linalg.norm(rest[self._ends[:, 1]] - rest[self._ends[:, 0]], axis=1)
        self._angles = self._all_angles(rest)
        area = float(np.linalg.norm(normals(rest, self._faces), axis=1).sum()) / 2
        self._scale = float(np.ptp(rest, axis=0).max()) / area if area > 0 else 0.0

    def bent(self, y: ArrayLike) -> float:
        """Return `sum_e l_e |angle_e(y) - angle_e(x)| s / A` over the edges between two triangles.

        The angle is that between the two normals, signed, `l` an edge's length, `A` the area of the surface, `s` the
        longest side of its box, all at rest: twice the mean change of integrated mean curvature, which no single needle
        decides.
        """
        after = as_points("y", y, 3)
        whole = sound(after, self._faces)[self._pair].all(axis=1)
        change = np.abs((self._all_angles(after) - self._angles + np.pi) % (2 * np.pi) - np.pi)
        return float((self._length * change)[whole].sum() * self._scale)

    def _all_angles(self, x: Array) -> Array:
        normal = normals(x, self._faces)
        along = x[self._ends[:, 1]] - x[self._ends[:, 0]]
        length = np.linalg.norm(along, axis=1)
        along /= np.where(length > 0, length, 1.0)[:, None]
        one, other = normal[self._pair[:, 0]], normal[self._pair[:, 1]] * self._way[:, None]
        angles: Array = np.arctan2((np.cross(one, other) * along).sum(axis=1), (one * other).sum(axis=1))
        return angles


def _once(rows: Indices) -> Indices:
    """The first of each of several equal rows."""
    order = np.lexsort(rows.T[::-1])
    new = np.ones(len(rows), dtype=bool)
    new[1:] = (rows[order][1:] != rows[order][:-1]).any(axis=1)
    found: Indices = order[new]
    return found


def _pairs(sides: Indices) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """The two sides of each edge that has exactly two."""
    low, high = np.sort(sides, axis=1).T
    order = np.lexsort([high, low])
    same = (low[order][1:] == low[order][:-1]) & (high[order][1:] == high[order][:-1])
    before, after = np.append(False, same), np.append(same, False)
    start = np.flatnonzero(~before & after)
    start = start[~after[start + 1]]
    return order[start], order[start + 1]
