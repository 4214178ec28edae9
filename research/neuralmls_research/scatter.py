"""The paper's scatter (figure 6): distortion against the error of the control points, a colour a method."""

from __future__ import annotations

import io
import os
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from neuralmls.errors import ArgumentError, FileError, NeuralMLSError
from neuralmls.plugin import RESEARCH, write_atomically

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


def scatter(points: Mapping[str, ArrayLike], path: str | os.PathLike[str], *, x_label: str, y_label: str) -> None:
    """Draw the points of each method into a PNG file; down and to the left is better.

    Parameters
    ----------
    points : methods' names -> (k, 2)
        What is on the x axis, and what on the y axis; what is not finite is not drawn.
    path : path that ends in .png
    x_label, y_label : what the axes show, with their units

    Raises
    ------
    NeuralMLSError
        Matplotlib is not installed.
    FileError
        `path` does not end in .png, or cannot be written.
    ArgumentError
        There is no finite point.
    """
    if Path(path).suffix.lower() != ".png":
        raise FileError(f"{path}: expected a name that ends in .png")
    matplotlib_or_refuse()
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.0, 5.0), dpi=160, layout="constrained")
    axes = figure.add_subplot()
    drawn = []
    for number, (name, values) in enumerate(points.items()):
        pairs = np.asarray(values, dtype=np.float64).reshape(-1, 2)
        pairs = pairs[np.isfinite(pairs).all(axis=1)]
        if len(pairs):
            axes.scatter(
                pairs[:, 0], pairs[:, 1], label=name, marker=MARKS[number % len(MARKS)], s=48, alpha=0.85, linewidths=0
            )
            drawn.append(pairs)
    if not drawn:
        raise ArgumentError(f"{path}: expected at least one finite point to draw, found none")
    together = np.concatenate(drawn)
    for axis, values in zip("xy", together.T, strict=True):
        if values.min() > 0 and values.max() > SPREAD * values.min():
            axes.set(**{f"{axis}scale": "log"})
        elif values.min() >= 0 and values.max() > 0:  # from 0 on, so that distances on paper mean what they say
            axes.set(**{f"{axis}lim": (-0.02 * values.max(), 1.08 * values.max())})
    axes.set_xlabel(x_label)
    axes.set_ylabel(y_label)
    axes.grid(alpha=0.25)
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(frameon=False)
    out = io.BytesIO()
    figure.savefig(out, format="png")
    write_atomically(path, out.getvalue())
