"""How the pictures look: plots (Matplotlib) and shapes (PyVista) in one style."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from neuralmls.figures.palette import heat
from neuralmls_research.experiments.reproduce import formats
from neuralmls_research.experiments.reproduce.lab import Lab
from neuralmls_research.experiments.reproduce.subjects import Subject

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Array = NDArray[np.float64]

# Okabe and Ito, 2008: told apart by all eyes; yellow left out, which is too pale for lines.
COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00", "#555555", "#882255")
NEURAL, CLASSIC = COLOURS[0], COLOURS[1]
STYLE: Any = {
    "font.size": 10,
    "axes.titlesize": 11,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.edgecolor": "#666666",
    "axes.grid": True,
    "grid.color": "#e6e6e6",
    "axes.axisbelow": True,
    "legend.frameon": False,
    "lines.linewidth": 1.8,
    **formats.VECTORS,
}


@contextmanager
def plots(lab: Lab, file: str, rows: int, columns: int, size: tuple[float, float], **options: Any) -> Iterator[Any]:
    """Give the axes of a figure of `size` inches, (rows, columns), and write it in all formats when the block ends.

    Raises
    ------
    FileError
        The file cannot be written.
    """
    from matplotlib import rc_context
    from matplotlib.figure import Figure

    with rc_context(STYLE):
        figure = Figure(figsize=size, layout="constrained")
        yield figure.subplots(rows, columns, squeeze=False, **options)
        formats.write_plot(figure, lab.folder / file, 60 if lab.quick else 150)


def draw_weights(
    axes: Axes, x: Array, w: Array, p: Array, title: str, top: float = 1.05, before: Array | None = None
) -> None:
    """Draw the weights (n, m) of control points p (m, 1) over x (n, 1) up to `top`, each with its point below.

    What they were `before`, (n, m), is drawn as thin broken lines behind.
    """
    if before is not None:
        axes.plot(x[:, 0], before, color="#777777", linewidth=0.8, linestyle="--")
    for i in range(w.shape[1]):
        colour = COLOURS[i % len(COLOURS)]
        axes.plot(x[:, 0], w[:, i], color=colour)
        axes.plot(p[i, 0], -0.06 * top, "o", color=colour, clip_on=False)
    axes.set_title(title)
    axes.set_ylim(-0.1 * top, top)
    axes.set_xlim(x[0, 0], x[-1, 0])


def draw_shapes(
    lab: Lab,
    file: str,
    subject: Subject,
    results: Mapping[str, Array],
    columns: int,
    colours: Sequence[Array] | None = None,
) -> None:
    """Draw a shape with its control points and what became of it, `columns` panels in a row.

    `colours`, (n, 3) for each panel, stand in for the shape's own.
    """
    from neuralmls.figures.render import Panel, render

    panels = [
        Panel(title, positions, subject.faces, colours=subject.colours if colours is None else colours[number])
        for number, (title, positions) in enumerate({"source": subject.positions, **results}.items())
    ]
    azimuth, elevation = subject.view
    render(
        panels,
        lab.folder / file,
        control_points=subject.points,
        columns=columns,
        width=120 * columns if lab.quick else min(1800, 420 * columns),
        azimuth=azimuth,
        elevation=elevation,
    )
    formats.embed(lab.folder / file)


def add_bar(lab: Lab, file: str, most: float, label: str) -> None:
    """Put a bar of the heat colours, from 0 to `most`, below a picture of shapes.

    Raises
    ------
    FileError
        The file cannot be written.
    """
    from matplotlib import rc_context
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import ListedColormap, Normalize
    from matplotlib.figure import Figure
    from matplotlib.image import imread

    picture = imread(lab.folder / file)
    height, width = picture.shape[:2]
    dots = 60 if lab.quick else 150
    room = 0.8  # inches for the bar
    with rc_context(STYLE):
        figure = Figure(figsize=(width / dots, height / dots + room))
        share = room / (height / dots + room)
        axes = figure.add_axes((0, share, 1, 1 - share))
        axes.imshow(picture, interpolation="none", aspect="auto")
        axes.set_axis_off()
        colours = ScalarMappable(Normalize(0, most), ListedColormap(heat(np.linspace(0, 1, 256))))
        bar = figure.add_axes((0.3, 0.65 * share, 0.4, 0.2 * share))
        figure.colorbar(colours, cax=bar, orientation="horizontal", label=label, extend="max")
        formats.write_plot(figure, lab.folder / file, dots)
