"""What `--move` and `--turn` say."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from neuralmls.errors import ArgumentError

if TYPE_CHECKING:
    from neuralmls.control_points import ControlPoints


def moved(points: ControlPoints, moves: Sequence[str], turns: Sequence[str]) -> ControlPoints:
    """Return control points with targets moved and orientations turned further.

    Raises
    ------
    ArgumentError
        There is no such control point, or it cannot be moved or turned so.
    """
    from neuralmls.orientations import Orientation

    points = points.moved(dict(offsets(moves)))
    for name, (axis, degrees) in axes(turns):
        if not axis and points.dimension == 3:
            raise ArgumentError(f"'{name}' is in space: it turns about an axis, of three numbers")
        if axis and points.dimension == 2:
            raise ArgumentError(f"'{name}' is in the plane: it turns about no axis")
        points = points.oriented({name: Orientation(axis or (0.0, 0.0, 1.0), degrees)})
    return points


def offsets(moves: Sequence[str]) -> Iterator[tuple[str, list[float]]]:
    """What `--move NAME=dx,dy,dz` says.

    Raises
    ------
    ArgumentError
        It is said otherwise, or of one name twice.
    """
    for name, numbers, text in _named("--move", "moved", moves):
        try:
            yield name, [_number(number) for number in numbers]
        except ValueError:
            raise ArgumentError(f"--move: expected NAME=dx,dy,dz, found '{text}'") from None


def axes(turns: Sequence[str]) -> Iterator[tuple[str, tuple[list[float], float]]]:
    """The axis, of 3 numbers or none, and the degrees that `--turn NAME=AXIS,DEGREES` says.

    Raises
    ------
    ArgumentError
        It is said otherwise, or of one name twice.
    """
    letters_of = {"x": [1.0, 0.0, 0.0], "y": [0.0, 1.0, 0.0], "z": [0.0, 0.0, 1.0]}
    for name, (*letters, degrees), text in _named("--turn", "turned", turns):
        try:
            known = letters_of.get("".join(letters)) or [_number(number) for number in letters]
            if len(known) not in (0, 3):
                raise ValueError
            yield name, (known, _number(degrees))
        except ValueError:
            expected = "NAME=AXIS,DEGREES with the axis x, y, z or three numbers (none in the plane)"
            raise ArgumentError(f"--turn: expected {expected}, found '{text}'") from None


def _named(option: str, done: str, texts: Sequence[str]) -> Iterator[tuple[str, list[str], str]]:
    """Name and numbers of each `NAME=NUMBERS`; a name may have = in it."""
    seen = set()
    for text in texts:
        name, _, numbers = text.rpartition("=")
        if name in seen:
            raise ArgumentError(f"{option}: '{name}' is {done} twice")
        seen.add(name)
        yield name, numbers.split(",") if name else ["no name"], text


def _number(text: str) -> float:
    """A number as a person writes it: Python would read 1_000 as one, too."""
    if "_" in text:
        raise ValueError
    return float(text)
