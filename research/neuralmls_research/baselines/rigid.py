"""The rigid motion that takes points nearest to others (Kabsch 1976)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def moved_rigidly(x: Array, p: Array, q: Array) -> Array:
    """Return the points `x` (n, 3) moved by the motion that takes `p` (m, 3) nearest to `q` (m, 3): never a reflection.

    `R = argmax over SO(3) of tr(R^T C)`, `C = sum_i (q_i - q*) (p_i - p*)^T`; what `p` leaves open, as the turn about a
    line, is any.

    Examples
    --------
    >>> p = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
    >>> moved_rigidly(np.array([[2.0, 0, 0]]), p, p[:, [1, 0, 2]] * [-1, 1, 1] + [3, 0, 5]).round(9).tolist()
    [[3.0, 2.0, 5.0]]
    """
    middle, goal = p.mean(axis=0), q.mean(axis=0)
    u, _, vt = np.linalg.svd((p - middle).T @ (q - goal))
    u[:, 2] *= np.linalg.det(u @ vt)
    moved: Array = (x - middle) @ (u @ vt) + goal
    return moved
