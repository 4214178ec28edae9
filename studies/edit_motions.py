"""What edits ask for: motions of space, in the shape's own directions.

A motion takes places (m, 3) and the halves of the shape's box (3,), both right, up, front from the box's middle, in
halves of its longest side, and says where the places go. "From" and "to" are in parts of the box: -1 at its one side, 1
at its other. What lies before "from" stays, what lies beyond "to" goes all the way.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

Array: TypeAlias = NDArray[np.float64]
Motion: TypeAlias = Callable[[Array, Array], Array]

RIGHT, UP, FRONT = 0, 1, 2
FLOOR, TOP = -1.0, 1.0


def along(u: Array, half: Array, axis: int, start: float, end: float) -> Array:
    """How far each place is from start to end, 0 to 1."""
    share: Array = np.clip((u[:, axis] / half[axis] - start) / (end - start), 0, 1)
    return share


def longer(axis: int, start: float, end: float, by: float) -> Motion:
    """Stretched between two places of an axis; what lies beyond goes along by `by`."""

    def motion(u: Array, half: Array) -> Array:
        moved = u.copy()
        moved[:, axis] += by * along(u, half, axis, start, end)
        return moved

    return motion


def wider(axis: int, inner: float, by: float) -> Motion:
    """What lies beyond `inner` to either side goes outwards as it is, by `by`; what lies between is stretched."""

    def motion(u: Array, half: Array) -> Array:
        moved = u.copy()
        moved[:, axis] += by * np.clip(u[:, axis] / half[axis] / inner, -1, 1)
        return moved

    return motion


def swept(out: int, way: int, start: float, by: float) -> Motion:
    """What is far out to either side goes along another axis, the farther the more: wings swept, or raised."""

    def motion(u: Array, half: Array) -> Array:
        moved = u.copy()
        moved[:, way] += by * np.clip((np.abs(u[:, out] / half[out]) - start) / (1 - start), 0, 1)
        return moved

    return motion


def flared(axis: int, start: float, end: float, by: float) -> Motion:
    """Made wider across an axis, the more the farther along it: legs splayed, a cabin tapered."""

    def motion(u: Array, half: Array) -> Array:
        moved = u * (1 + by * along(u, half, axis, start, end))[:, None]
        moved[:, axis] = u[:, axis]
        return moved

    return motion


def turned(about: int, axis: int, start: float, end: float, degrees: float, hinge: Array | None = None) -> Motion:
    """Turned about an axis through a hinge (in parts of the box; its middle if not given): leaned, bent, twisted."""
    middle = np.zeros(3) if hinge is None else np.asarray(hinge, dtype=np.float64)

    def motion(u: Array, half: Array) -> Array:
        angle = np.radians(degrees) * along(u, half, axis, start, end)
        first, second = (about + 1) % 3, (about + 2) % 3
        cos, sin = np.cos(angle), np.sin(angle)
        off = u - middle * half
        moved = u.copy()
        moved[:, first] += (cos - 1) * off[:, first] - sin * off[:, second]
        moved[:, second] += sin * off[:, first] + (cos - 1) * off[:, second]
        return moved

    return motion


def legs(seat: float, by: float) -> Motion:
    """What is below a seat made longer: feet go down by `by`."""
    return longer(UP, seat, FLOOR, -by)


def leaned(seat: float, degrees: float) -> Motion:
    """What is above a seat leaned back, about where it meets the seat."""
    return turned(RIGHT, UP, seat, seat + 0.1, -degrees, np.array([0, seat, -0.8]))
