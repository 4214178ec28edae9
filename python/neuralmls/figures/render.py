"""Pictures of shapes side by side: shaded, with control points as balls and arrows to their targets."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, TypedDict, Unpack

import numpy as np
from numpy.typing import ArrayLike, NDArray

from neuralmls.control_points import ControlPoints
from neuralmls.errors import ArgumentError, FileError
from neuralmls.figures.camera import fitted
from neuralmls.figures.page import png
from neuralmls.figures.palette import CLAY, SOURCE, TARGET, heat
from neuralmls.figures.picture import Picture
from neuralmls.figures.stage import Stage, pyvista_or_refuse

Array = NDArray[np.float64]

ASPECTS = (0.6, 2.2)  # the least and the greatest width by height of a panel


@dataclass(frozen=True)
class Panel:
    """One shape of a figure.

    Attributes
    ----------
    title : str
    positions : (n, d), d = 1, 2 or 3
    faces : (f, 3) integers, or None for a point cloud
    colours : (n, 3), 0 to 1, optional
        Red, green, blue of each point; without them everything is clay.
    weights : (n,), 0 to 1, optional
        One control point's weights, or another share, drawn as a heat map in place of colours.
    """

    title: str
    positions: ArrayLike
    faces: ArrayLike | None = None
    colours: ArrayLike | None = None
    weights: ArrayLike | None = None


class View(TypedDict, total=False):
    """How a picture is seen, as `draw` explains it."""

    width: int
    columns: int | None
    azimuth: float
    elevation: float
    up: Literal["y", "z"]


def render(
    panels: Sequence[Panel],
    path: str | os.PathLike[str],
    *,
    control_points: ControlPoints | None = None,
    **view: Unpack[View],
) -> None:
    """Draw panels side by side into a PNG file: `draw`, written.

    Raises
    ------
    NeuralMLSError
        PyVista is not installed, or cannot draw on this machine.
    FileError
        `path` does not end in .png, or cannot be written.
    ArgumentError
        There is no panel, or its arrays do not fit each other.
    """
    if Path(path).suffix.lower() != ".png":
        raise FileError(f"{path}: expected a name that ends in .png")
    draw(panels, control_points=control_points, **view).write(path)


def draw(
    panels: Sequence[Panel],
    *,
    control_points: ControlPoints | None = None,
    scale: tuple[str, str] = ("weight  0", "1"),
    width: int = 1600,
    columns: int | None = None,
    azimuth: float = 32.0,
    elevation: float = 18.0,
    up: str = "y",
) -> Picture:
    """Draw panels side by side, all seen by the same camera; no display is needed.

    Parameters
    ----------
    panels : sequence of Panel, at least one
    control_points : ControlPoints, optional
        Drawn as balls at their sources with arrows to their targets in the first panel, as balls at their targets
        in the others. What lies inside of the shape shines through.
    scale : two strings
        What the legend says at both ends of the heat map, if a panel has one.
    width : int, pixels
        The height follows from what is to be seen.
    columns : int, optional
        Panels in a row; all of them if not given.
    azimuth, elevation : float, degrees
        Where the camera stands: turned from the front to the shape's left, risen from the ground.
    up : "y" or "z"

    Raises
    ------
    NeuralMLSError
        PyVista is not installed, or cannot draw on this machine.
    ArgumentError
        There is no panel, or its arrays do not fit each other.
    """
    row = len(panels) if columns is None else columns
    if not panels or row < 1 or up not in ("y", "z") or not 64 * row <= width <= 16384:
        found = f"{len(panels)} panels, {row} in a row, {up}, {width} pixels"
        raise ArgumentError(
            f"expected at least one panel, up as y or z, a width of 64 pixels a panel to 16384, found {found}"
        )
    pyvista = pyvista_or_refuse()
    shapes = [_in_space(panel.positions, panel.title) for panel in panels]
    faces = [_faces(panel, shape) for panel, shape in zip(panels, shapes, strict=True)]
    colours = [_colours(panel, len(shape)) for panel, shape in zip(panels, shapes, strict=True)]
    seen = list(shapes)
    if control_points is not None:
        p, q = _in_space(control_points.sources, "sources"), _in_space(control_points.targets, "targets")
        seen += [p, q]
    everything = np.concatenate(seen)
    origin = (everything.min(axis=0) + everything.max(axis=0)) / 2
    size = float(np.ptp(everything, axis=0).max()) or 1.0
    everything = (everything - origin) / size  # graphics cards count in single precision

    panel_width = width // row
    camera = fitted(everything, azimuth=azimuth, elevation=elevation, up=up, aspects=ASPECTS)
    pictures = []
    for number in range(len(panels)):
        stage = Stage(pyvista, panel_width, round(panel_width / camera.aspect), camera)
        shape = (shapes[number] - origin) / size
        if len(faces[number]):
            stage.surface(shape, faces[number], colours[number])
        else:
            stage.cloud(shape, colours[number])
        if control_points is not None:
            stage.balls(((p if number == 0 else q) - origin) / size, SOURCE if number == 0 else TARGET)
            if number == 0:
                stage.arrows((p - origin) / size, (q - origin) / size, TARGET)
        pictures.append(stage.picture())
    titles = [panel.title for panel in panels]
    ends = scale if any(panel.weights is not None for panel in panels) else None
    legend = [] if control_points is None else [(SOURCE, "control point")]
    if legend and (len(panels) > 1 or (p != q).any()):
        legend.insert(0, (TARGET, "target"))
    return Picture(png(pictures, titles, width, columns=row, legend=legend, scale=ends))


def _in_space(values: ArrayLike, what: str) -> Array:
    points = np.asarray(values, dtype=np.float64)
    if points.ndim != 2 or not points.size or points.shape[1] > 3 or not np.isfinite(points).all():
        expected = "finite positions (n, d), n > 0, d = 1, 2 or 3"
        raise ArgumentError(f"{what}: expected {expected}, found {points.shape}")
    return np.pad(points, ((0, 0), (0, 3 - points.shape[1])))


def _faces(panel: Panel, shape: Array) -> NDArray[np.int64]:
    """The faces of a panel that have area, (f, 3); none for a cloud, or what is to be drawn as one."""
    count = len(shape)
    faces = np.zeros((0, 3), dtype=np.int64) if panel.faces is None else np.asarray(panel.faces, dtype=np.int64)
    if faces.ndim != 2 or faces.shape[1] != 3 or (faces < 0).any() or (faces >= count).any():
        raise ArgumentError(f"{panel.title}: expected faces (f, 3) that name points 0 to {count - 1}")
    a, b, c = (shape[faces[:, corner]] for corner in range(3))
    return faces[np.cross(b - a, c - a).any(axis=1)]


def _colours(panel: Panel, count: int) -> NDArray[np.uint8]:
    """The colours of a panel's points, (n, 3)."""
    if panel.weights is not None:
        colours = heat(_of_shape(panel.weights, (count,), panel.title))
    elif panel.colours is not None:
        colours = _of_shape(panel.colours, (count, 3), panel.title)
    else:
        colours = np.broadcast_to(CLAY, (count, 3))
    return (np.clip(colours, 0.0, 1.0) * 255).round().astype(np.uint8)


def _of_shape(values: ArrayLike, shape: tuple[int, ...], title: str) -> Array:
    array = np.asarray(values, dtype=np.float64)
    if array.shape != shape:
        raise ArgumentError(f"{title}: expected an array of shape {shape}, found {array.shape}")
    return array
