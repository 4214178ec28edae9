"""The paper's scatter (figure 6): distortion against the error of the control points, a colour and mark a method."""

from __future__ import annotations

import io
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from neuralmls.errors import ArgumentError, FileError, NeuralMLSError
from neuralmls.plugin import RESEARCH, write_atomically

if TYPE_CHECKING:
    from matplotlib.axes import Axes

MARKS = "os^Dv<>phX"
SPREAD = 30.0  # values that differ by a greater factor are drawn on a logarithmic axis


def matplotlib_or_refuse() -> None:
    """Import Matplotlib.

    Raises
    ------
    NeuralMLSError
        It is not installed.
    """
    try:
        import matplotlib.figure  # noqa: F401
    except ImportError as error:
        raise NeuralMLSError(f"scatters need Matplotlib, which is not installed: {RESEARCH}") from error


@dataclass(frozen=True)
class Panel:
    """One of the scatters side by side; down and to the left is better.

    Attributes
    ----------
    points : methods' names -> (k, 2)
        What is on the x axis, and what on the y axis; what is not finite is not drawn.
    x_label, y_label : what the axes show, with their units
    """

    points: Mapping[str, ArrayLike]
    x_label: str
    y_label: str


def scatter(rows: Sequence[Sequence[Panel]], path: str | os.PathLike[str]) -> None:
    """Draw scatters, in rows of equal length, into a PNG file; a method looks the same in all of them.

    Raises
    ------
    NeuralMLSError
        Matplotlib is not installed.
    FileError
        `path` does not end in .png, or cannot be written.
    ArgumentError
        There is no finite point in any.
    """
    if Path(path).suffix.lower() != ".png":
        raise FileError(f"{path}: expected a name that ends in .png")
    matplotlib_or_refuse()
    from matplotlib.figure import Figure

    names = list(dict.fromkeys(name for row in rows for panel in row for name in panel.points))
    size = (2.5 + 4.5 * len(rows[0]), 0.8 + 4.0 * len(rows))
    figure = Figure(figsize=size, dpi=160, layout="constrained")
    grid = figure.subplots(len(rows), len(rows[0]), squeeze=False)
    panels = [panel for row in rows for panel in row]
    drawn = [_draw(axes, panel, names) for panel, axes in zip(panels, grid.flat, strict=True)]
    if not any(drawn):
        raise ArgumentError(f"{path}: expected at least one finite point to draw, found none")
    legend = {text: mark for axes in grid.flat for mark, text in zip(*axes.get_legend_handles_labels(), strict=True)}
    figure.legend(legend.values(), legend.keys(), loc="outside right upper", frameon=False)
    out = io.BytesIO()
    figure.savefig(out, format="png")
    write_atomically(path, out.getvalue())


def _draw(axes: Axes, panel: Panel, names: list[str]) -> bool:
    """Draw one scatter; return whether there was anything to draw."""
    drawn = []
    for name, values in panel.points.items():
        pairs = np.asarray(values, dtype=np.float64).reshape(-1, 2)
        pairs = pairs[np.isfinite(pairs).all(axis=1)]
        if len(pairs):
            number = names.index(name)
            mark, colour = MARKS[number % len(MARKS)], f"C{number % 10}"
            axes.scatter(
                pairs[:, 0], pairs[:, 1], label=name, marker=mark, color=colour, s=48, alpha=0.85, linewidths=0
            )
            drawn.append(pairs)
    axes.set(xlabel=panel.x_label, ylabel=panel.y_label)
    axes.grid(alpha=0.25)
    axes.spines[["top", "right"]].set_visible(False)
    if drawn:
        _limit(axes, np.concatenate(drawn))
    return bool(drawn)


def _limit(axes: Axes, together: NDArray[np.float64]) -> None:
    for axis, values in zip("xy", together.T, strict=True):
        if values.min() > 0 and values.max() > SPREAD * values.min():
            axes.set(**{f"{axis}scale": "log"})
        elif values.min() >= 0 and values.max() > 0:  # from 0 on, so that distances on paper mean what they say
            axes.set(**{f"{axis}lim": (-0.02 * values.max(), 1.08 * values.max())})
