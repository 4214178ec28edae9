"""Oriented control points: a rotation, and a scale, that a control point carries besides its target."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from neuralmls._core import Orientation
from neuralmls.errors import ArgumentError

__all__ = ["Orientation", "Rotations", "Scales", "as_orientations"]

Array: TypeAlias = NDArray[np.float64]
# One for each control point, None or NaN for those that carry none.
Rotations: TypeAlias = Sequence[ArrayLike | None] | ArrayLike | None
Scales: TypeAlias = Sequence[float | None] | ArrayLike | None


def as_orientations(
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
    scaled = np.full((count, dimension, dimension), np.nan)
    for i, rotation in enumerate(_listed("rotations", rotations, count)):
        if rotation is not None and not _is_nan(rotation):
            scaled[i] = _one(rotation, i, dimension)
    for i, scale in enumerate(_listed("scales", scales, count)):
        if scale is None or _is_nan(scale):
            continue
        number = np.asarray(scale)
        if number.shape or number.dtype.kind not in "fiu" or not 0 < number < np.inf:
            raise ArgumentError(f"scales: expected a number above 0 for control point {i}, found {scale!r}")
        scaled[i] = float(number) * (np.eye(dimension) if np.isnan(scaled[i]).any() else scaled[i])
    return None if np.isnan(scaled[:, 0, 0]).all() else scaled


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
    try:
        Orientation.of(np.ascontiguousarray(matrix))  # refuses what is no rotation
    except ArgumentError as error:
        raise ArgumentError(f"{what}{str(error).removeprefix('matrix')}") from None
    return matrix
