"""What a command reads: shapes that have a size, and sessions that fit them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from neuralmls.errors import ArgumentError, ControlPointError, FileError

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from neuralmls.control_points import ControlPoints
    from neuralmls.session import Session
    from neuralmls.shape import Shape

STANDARD_INPUT = Path("-")


def read_shape(path: Path, *, sized: bool = True) -> Shape:
    """Read a shape, - from standard input; a `sized` one, which lengths are to be measured by.

    Raises
    ------
    FileError
        It cannot be read, is longer than numbers can hold, or is `sized` and has no size.
    """
    from neuralmls.files import read_standard_input
    from neuralmls.shape import decode, read

    shape = decode(read_standard_input(), Path("standard input")) if path == STANDARD_INPUT else read(path)
    longest_side(shape)
    if sized:
        check_size(shape)
    return shape


def check_size(shape: Shape) -> None:
    """Refuse a shape without a size, or with one that no number could hold.

    Raises
    ------
    FileError
        It has none; the message names the file.
    """
    from neuralmls import _core

    try:
        _core.check_size(shape.bounds, len(shape.positions))
    except FileError as error:
        raise FileError(f"{shape.path}: {error}") from None


def longest_side(shape: Shape) -> float:
    """The longest side of the shape's box, in file units.

    Raises
    ------
    FileError
        It is so long that squares of lengths overflow.
    """
    from neuralmls import _core

    try:
        return _core.longest_side(shape.bounds)
    except FileError as error:
        raise FileError(f"{shape.path}: {error}") from None


def read_session(points: Path, targets: Path | None = None, *, by_order: bool = False) -> Session:
    """Read control points, - from standard input; of two files sources and targets.

    Raises
    ------
    ArgumentError
        Both come from standard input, or an order is asked for that there is no second file for.
    FileError, ControlPointError
        As `Session.read`.
    """
    from neuralmls.session import Session

    if by_order and targets is None:
        raise ArgumentError("--by-order: expected a second file of control points with --targets")
    if points == STANDARD_INPUT == targets:
        raise ArgumentError("--targets: standard input was read already for --points")
    return Session.read(points, targets, by_order=by_order)


def check_points(points: ControlPoints, file: Path | None, shape: Shape) -> list[str]:
    """Warn of control points that do not fit the shape.

    Raises
    ------
    ControlPointError
        They have another dimension than the shape, or are nowhere near anything; the message names both files.
    """
    try:
        return points.check(shape.bounds)
    except ControlPointError as error:
        raise ControlPointError(f"{'the map' if file is None else file}, for {shape.path}: {error}") from None


def check_together(
    points: ControlPoints, shapes: Sequence[Shape], frame: NDArray[np.float64] | None = None
) -> list[str]:
    """Warn of control points that do not fit shapes which one map bends: in the box around all of them and its frame.

    Raises
    ------
    ControlPointError
        As `check_points`, which names the files.
    """
    boxes = [shape.bounds for shape in shapes] + ([] if frame is None else [frame])
    low, high = boxes[0]
    for box in boxes[1:]:
        low, high = low.clip(max=box[0]), high.clip(min=box[1])
    return points.check([low, high])


def one_standard_input(paths: Iterable[Path | None]) -> None:
    """Refuse to read two things from standard input.

    Raises
    ------
    ArgumentError
        More than one of the paths is -.
    """
    if sum(path == STANDARD_INPUT for path in paths) > 1:
        raise ArgumentError("-: standard input holds one file, but more than one is to be read from it")


def settings_of(said: dict[str, Any], session: Session) -> Session:
    """Return the session with what the person said in the place of its own settings."""
    return session.replace(**said) if said else session
