"""The volume that a closed surface holds."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from neuralmls.plugin import as_points, as_triangles
from neuralmls_research.metrics.triangles import Array, Indices, as_surface, places


def volume(x: ArrayLike, faces: ArrayLike) -> float | None:
    """Return the volume that a closed surface holds, `sum a . (b x c) / 6`; None if it is not closed.

    It is closed if, vertices in one place taken as one, every edge is walked as often one way as the other.

    Returns
    -------
    float, cubic units of `x`, negative if the triangles look inward; or None

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
