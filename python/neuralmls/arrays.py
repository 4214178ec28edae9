"""Arguments as the compiled core takes them: C-contiguous float64, checked, never the caller's memory changed."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from neuralmls.errors import ArgumentError

# Told the fraction done, from 0 to 1; what it raises stops the call.
Progress: TypeAlias = Callable[[float], None]


def as_points(name: str, values: ArrayLike, dimension: int | None = None) -> NDArray[np.float64]:
    """Return finite points (n, d), d = 1, 2 or 3, or `dimension` if given.

    Raises
    ------
    ArgumentError
        The values are not numbers of that shape, or one is not finite.
    """
    try:
        if np.iscomplexobj(values):
            raise TypeError("they are complex")
        points = np.ascontiguousarray(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise ArgumentError(f"{name}: expected an (n, d) array of numbers: {error}") from error
    if points.ndim != 2 or not 1 <= points.shape[1] <= 3:
        raise ArgumentError(f"{name}: expected an (n, d) array with d = 1, 2 or 3, found shape {points.shape}")
    if dimension is not None and points.shape[1] != dimension:
        raise ArgumentError(f"{name}: expected {dimension} coordinates a point, found {points.shape[1]}")
    finite = np.isfinite(points)
    if not finite.all():  # by far quicker than row by row
        bad = np.flatnonzero(~finite.all(axis=1))
        raise ArgumentError(f"{name}: point {bad[0]} has a coordinate that is not finite")
    return points


def as_rows(points: ArrayLike) -> tuple[ArrayLike, tuple[int, ...] | None]:
    """Return a grid of points (h, w, d), or of more axes, as rows (n, d), with its axes; what is none as it is."""
    try:
        if np.ndim(points) <= 2:
            return points, None
    except ValueError:  # of rows of several lengths, which as_points refuses
        return points, None
    grid = np.asarray(points)
    return grid.reshape(-1, grid.shape[-1]), grid.shape[:-1]


def dtype_of(points: ArrayLike) -> np.dtype[np.floating]:
    """Return what is to be returned for points: float32 if they are, else float64."""
    given = getattr(points, "dtype", np.dtype(np.float64))
    single = given.kind == "f" and given.itemsize == 4  # whatever its byte order
    return np.dtype(np.float32 if single else np.float64)


def as_triangles(faces: ArrayLike, count: int) -> NDArray[np.int64]:
    """Return triangles (f, 3) that name vertices below `count`.

    Raises
    ------
    ArgumentError
        They are of another shape, no whole numbers, or name other vertices.
    """
    try:
        found = np.asarray(faces)
    except (TypeError, ValueError) as error:
        raise ArgumentError(f"faces: expected an (f, 3) array of whole numbers: {error}") from error
    if found.ndim != 2 or found.shape[1] != 3 or found.dtype.kind not in "iu":
        raise ArgumentError(
            f"faces: expected an (f, 3) array of whole numbers, found shape {found.shape}, {found.dtype}"
        )
    if found.size and (found.min() < 0 or found.max() >= count):
        raise ArgumentError(f"faces: expected vertices 0 to {count - 1}, found {found.min()} to {found.max()}")
    return found.astype(np.int64)


def as_number(name: str, value: float, low: float, high: float = np.inf, *, open_low: bool = True) -> float:
    """Return a finite number above `low` (or from it on) and up to `high`.

    Raises
    ------
    ArgumentError
        It is none, or out of that range.
    """
    expected = f"above {low:g}" if open_low else f"of at least {low:g}"
    if high < np.inf:
        expected += f" and at most {high:g}"
    try:
        number = float(value)
    except (TypeError, ValueError):
        raise ArgumentError(f"{name}: expected a number {expected}, found {value!r}") from None
    if not np.isfinite(number) or number > high or number < low or (open_low and number == low):
        raise ArgumentError(f"{name}: expected a number {expected}, found {value!r}")
    return number


def as_count(name: str, value: int, low: int, high: int) -> int:
    """Return a whole number from `low` to `high`.

    Raises
    ------
    ArgumentError
        It is none, or out of that range.
    """
    try:
        count = value.__index__()
    except AttributeError:
        raise ArgumentError(f"{name}: expected a whole number, found {value!r}") from None
    if not low <= count <= high:
        raise ArgumentError(f"{name}: expected a whole number from {low} to {high}, found {value}")
    return count


def as_box(bounds: ArrayLike, dimension: int) -> NDArray[np.float64]:
    """Return a box (2, d): least and greatest corner.

    Raises
    ------
    ArgumentError
        It is no such box, or has no size.
    """
    box = as_points("bounds", bounds, dimension)
    if len(box) != 2 or (box[0] > box[1]).any():
        raise ArgumentError("bounds: expected two rows, the least and the greatest corner of the shape's box")
    if (box[0] == box[1]).all():
        raise ArgumentError("bounds: all points are in one place, so that there is no size to measure by")
    return box


def box_around(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the box of points (n, d), at least one: least and greatest corner, (2, d)."""
    return np.stack([points.min(axis=0), points.max(axis=0)])
