"""What `Shape.plot` and `Map.plot` draw: a shape, or a shape at rest and where a map takes it."""

from __future__ import annotations

import difflib
from collections.abc import Callable, Sequence
from typing import TypeAlias, Unpack

import numpy as np
from numpy.typing import ArrayLike, NDArray

from neuralmls.control_points import ControlPoints
from neuralmls.errors import ArgumentError
from neuralmls.figures.picture import Picture
from neuralmls.figures.render import Panel, View, draw

Array: TypeAlias = NDArray[np.float64]

WIDTH = 720  # pixels; of a notebook's column
DISPLACEMENT = "displacement"


def of_shape(
    x: Array, faces: ArrayLike | None, title: str, points: ControlPoints | None, **view: Unpack[View]
) -> Picture:
    """Draw points x (n, d) with their faces and, if given, control points with arrows to their targets."""
    return draw([Panel(title, x, faces)], control_points=points, **_seen(x.shape[1], 0.5, view))


def of_map(
    x: Array,
    y: Array,
    faces: ArrayLike | None,
    points: ControlPoints,
    heat: str | int | None,
    weights: Callable[[], Array],
    **view: Unpack[View],
) -> Picture:
    """Draw points x (n, d) at rest, and y (n, d) where they go, with the heat that `Map.plot` explains.

    `weights` returns the weights (n, m); it is called only where the heat is that of a control point.
    """
    values, scale, suffix = None, ("", ""), ""
    if heat is not None:
        values, scale, suffix = _heat(x, y, points.names, heat, weights)
    panels = [Panel(f"at rest{suffix}", x, faces, weights=values), Panel("deformed", y, faces, weights=values)]
    return draw(panels, control_points=points, scale=scale, **_seen(x.shape[1], 1.0, view))


def _heat(
    x: Array, y: Array, names: Sequence[str], heat: str | int, weights: Callable[[], Array]
) -> tuple[Array, tuple[str, str], str]:
    """The heat of each point, 0 to 1, what the legend says at its ends, and what the title adds."""
    if heat == DISPLACEMENT and DISPLACEMENT not in names:
        far = np.linalg.norm(y - x, axis=1)
        farthest = float(far.max(initial=0.0))
        return far / (farthest or 1.0), ("moved  0", f"{farthest:.3g}"), ""
    number = number_of(heat, names, "heat")
    return weights()[:, number], ("weight  0", "1"), f", weight of {names[number]}"


def number_of(control_point: str | int, names: Sequence[str], what: str) -> int:
    """Return the number, from 0, of a control point that is given by its number or its name.

    Raises
    ------
    ArgumentError
        There is none; the message begins with `what`.

    Examples
    --------
    >>> number_of("top", ["foot", "top"], "heat"), number_of(0, ["foot", "top"], "heat")
    (1, 0)
    """
    if isinstance(control_point, str):
        if control_point in names:
            return names.index(control_point)
        nearest = difflib.get_close_matches(control_point, names, n=1, cutoff=0.0)[0]
        raise ArgumentError(f"{what}: there is no control point '{control_point}'; the nearest name is '{nearest}'")
    if not isinstance(control_point, int | np.integer) or not 0 <= control_point < len(names):
        expected = f"a control point's name, or its number from 0 to {len(names) - 1}"
        raise ArgumentError(f"{what}: expected {expected}, found {control_point!r}")
    return int(control_point)


def _seen(dimension: int, share: float, view: View) -> View:
    """How it is seen unless told otherwise: as wide as a notebook shows it; what is flat, from the front."""
    width: View = {"width": round(WIDTH * share)}
    front: View = {"azimuth": 0.0, "elevation": 0.0} if dimension < 3 else {}
    return {**width, **front, **view}
