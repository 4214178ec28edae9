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
LARGEST = 1e150  # units; beyond it, squares of lengths overflow


def read_shape(path: Path) -> Shape:
    """Read a shape, - from standard input, that has a size.

    Raises
    ------
    FileError
        It cannot be read, or all of its vertices are in one place, so that there is nothing to measure by.
    """
    from neuralmls.files import read_standard_input
    from neuralmls.shape import decode, read

    shape = decode(read_standard_input(), Path("standard input")) if path == STANDARD_INPUT else read(path)
    check_size(shape)
    return shape


def check_size(shape: Shape) -> None:
    """Refuse a shape without any extent, which there is nothing to measure by.

    Raises
    ------
    FileError
        All vertices are in one place.
    """
    if not longest_side(shape) > 0:
        count = len(shape.positions)
        found = "there is only one vertex" if count == 1 else f"all {count} vertices are in one place"
        raise FileError(f"{shape.path}: {found}, so that there is no size to measure by")


def longest_side(shape: Shape) -> float:
    """The longest side of the shape's box, in file units.

    Raises
    ------
    FileError
        It is so long that squares of lengths overflow.
    """
    low, high = shape.bounds
    if (high / LARGEST - low / LARGEST).max() > 1:
        raise FileError(f"{shape.path}: the shape is more than {LARGEST:g} units long: no coordinates of a real thing")
    return float((high - low).max())


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
