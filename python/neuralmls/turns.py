"""Turned control points: a rotation, and a scale, that a control point carries besides its target."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from neuralmls.errors import ArgumentError

Array: TypeAlias = NDArray[np.float64]
# One for each control point, None or NaN for those that carry none.
Rotations: TypeAlias = Sequence[ArrayLike | None] | ArrayLike | None
Scales: TypeAlias = Sequence[float | None] | ArrayLike | None

# Rounding, and a file's last digits, may leave this much of `R^T R - I`.
ROUNDING = 1e-6


@dataclass(frozen=True)
class Turn:
    """How a control point is turned: about an axis, by an angle, and scaled.

    Attributes
    ----------
    axis : tuple of 3 floats, not all 0, of any length; in the plane and on a line: ()
        The axis. Seen from its tip, positive angles turn counterclockwise.
    degrees : float
        The angle; on a line 0.
    scale : float > 0
        How much larger the surroundings become. Rigid deformations leave it away.

    Raises
    ------
    ArgumentError
        A number is out of its range.

    Examples
    --------
    >>> Turn((0, 0, 1), 90).matrix.round(6).tolist()
    [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]
    """

    axis: tuple[float, ...] = ()
    degrees: float = 0.0
    scale: float = 1.0

    def __post_init__(self) -> None:
        if len(self.axis) not in (0, 3) or not np.isfinite(self.axis).all() or (self.axis and not any(self.axis)):
            raise ArgumentError(f"axis: expected three finite numbers that are not all 0, found {list(self.axis)}")
        if not np.isfinite(self.degrees):
            raise ArgumentError(f"degrees: expected a finite number, found {self.degrees}")
        if not 0 < self.scale < np.inf:
            raise ArgumentError(f"scale: expected a number above 0, found {self.scale}")

    @classmethod
    def of(cls, matrix: ArrayLike, scale: float = 1.0) -> Turn:
        """Return the turn of a rotation matrix (d, d).

        Raises
        ------
        ArgumentError
            It is no rotation, or the scale is not above 0.
        """
        r = _rotation(np.array(matrix, dtype=np.float64), "matrix")
        if len(r) == 1:
            return cls(scale=scale)
        if len(r) == 2:
            return cls(degrees=float(np.degrees(np.arctan2(r[1, 0], r[0, 0]))), scale=scale)
        # The rotation's quaternion is the eigenvector of this matrix for its largest eigenvalue (Bar-Itzhack 2000).
        xx, yy, zz = np.diagonal(r)
        symmetric = r + r.T
        k = np.diag([xx - yy - zz, yy - xx - zz, zz - xx - yy, xx + yy + zz])
        for i, j in ((0, 1), (0, 2), (1, 2)):
            k[i, j] = k[j, i] = symmetric[i, j]
        k[3, :3] = k[:3, 3] = [r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1]]
        x, y, z, w = np.linalg.eigh(k)[1][:, 3]
        length = float(np.hypot(np.hypot(x, y), z))
        if length < 1e-12:  # as close to none as doubles tell
            return cls((0.0, 0.0, 1.0), 0.0, scale)
        side = 1.0 if w >= 0 else -1.0
        axis = tuple(float(side * c / length) + 0.0 for c in (x, y, z))
        return cls(axis, float(np.degrees(2 * np.arctan2(length, side * w))), scale)

    def fits(self, dimension: int) -> bool:
        """Whether a control point of `dimension` coordinates can turn so."""
        return bool(self.axis) == (dimension == 3) and (dimension > 1 or self.degrees == 0)

    @property
    def matrix(self) -> Array:
        """The rotation, (3, 3) with an axis, otherwise (2, 2)."""
        angle = np.radians(np.fmod(self.degrees, 360.0))
        cos, sin = float(np.cos(angle)), float(np.sin(angle))
        if not self.axis:
            return np.array([[cos, -sin], [sin, cos]])
        x, y, z = np.array(self.axis) / np.abs(self.axis).max()
        x, y, z = np.array([x, y, z]) / np.sqrt(x * x + y * y + z * z)
        cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
        matrix: Array = np.eye(3) + sin * cross + (1 - cos) * (cross @ cross)
        return matrix


def as_turns(
    rotations: Rotations,
    scales: Scales,
    count: int,
    dimension: int,
) -> Array | None:
    """Return `s_i R_i` of each control point (m, d, d), NaN for those that carry neither; None where none does.

    Raises
    ------
    ArgumentError
        There are not `count` of them, one is no rotation, or a scale is not above 0.
    """
    if rotations is None and scales is None:
        return None
    turns = np.full((count, dimension, dimension), np.nan)
    for i, rotation in enumerate(_listed("rotations", rotations, count)):
        if rotation is not None and not _is_nan(rotation):
            turns[i] = _one(rotation, i, dimension)
    for i, scale in enumerate(_listed("scales", scales, count)):
        if scale is None or _is_nan(scale):
            continue
        number = np.asarray(scale)
        if number.shape or number.dtype.kind not in "fiu" or not 0 < number < np.inf:
            raise ArgumentError(f"scales: expected a number above 0 for control point {i}, found {scale!r}")
        turns[i] = float(number) * (np.eye(dimension) if np.isnan(turns[i]).any() else turns[i])
    return None if np.isnan(turns[:, 0, 0]).all() else turns


def _listed(name: str, values: object, count: int) -> list[object]:
    """The values as a list; so many of nothing if there are none."""
    if values is None:
        return [None] * count
    try:
        listed: list[object] = list(values)  # type: ignore[call-overload]
    except TypeError:
        raise ArgumentError(f"{name}: expected one for each control point, or None, found {values!r}") from None
    if len(listed) != count:
        raise ArgumentError(f"{name}: expected {count} of them, found {len(listed)}")
    return listed


def _is_nan(value: object) -> bool:
    """Whether it is a number or an array of nothing but NaN."""
    try:
        return bool(np.isnan(np.asarray(value, dtype=np.float64)).all())
    except (TypeError, ValueError):
        return False


def _one(value: object, index: int, dimension: int) -> Array:
    what = f"rotations: that of control point {index}"
    try:
        matrix = np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise ArgumentError(f"{what} is no matrix of numbers: {error}") from error
    if matrix.shape != (dimension, dimension):
        raise ArgumentError(f"{what}: expected a matrix {(dimension, dimension)}, found shape {matrix.shape}")
    return _rotation(matrix, what)


def _rotation(matrix: Array, what: str) -> Array:
    """The matrix, if it is a rotation."""
    if matrix.ndim != 2 or matrix.shape[0] != matrix.shape[1] or not 1 <= len(matrix) <= 3:
        raise ArgumentError(f"{what}: expected a matrix (d, d) with d = 1, 2 or 3, found shape {matrix.shape}")
    if not np.isfinite(matrix).all():
        raise ArgumentError(f"{what} is not a rotation: it has numbers that are not finite")
    off = float(np.abs(matrix.T @ matrix - np.eye(len(matrix))).max())
    if off > ROUNDING:
        raise ArgumentError(f"{what} is not a rotation: its columns are not orthonormal, off by {off:.3g}")
    if np.linalg.det(matrix) < 0:
        raise ArgumentError(f"{what} is not a rotation: its determinant is -1, as a reflection's")
    return matrix
