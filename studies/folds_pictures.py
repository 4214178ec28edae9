"""The pictures of docs/no-folds.md: `python studies/folds_pictures.py FOLDER`."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import neuralmls as nm
from neuralmls.figures.render import Panel, render
from neuralmls.samples import make

Array = NDArray[np.float64]

# The back is pulled down through the seat, and past the armrests.
PULLED = {"back-top-left": (0.1, -0.45, 0.35), "back-top-right": (0.1, -0.45, 0.35)}
TURNS = 720


def main(folder: Path) -> None:
    """Draw a drag through neighbours, and a twist of two turns."""
    sample = make("chair")
    x, faces = sample.vertices, sample.triangles
    points = nm.ControlPoints(sample.control_points.sources, names=sample.control_points.names).moved(PULLED)
    panels = [Panel("at rest", x, faces, colours=sample.colours)]
    for title, no_folds in (("one step", False), ("no folds", True)):
        map = nm.Session(points, weights="neural", no_folds=no_folds).fit(x, faces=faces)
        said = f"{title}: {100 * folded(map, x, faces):.1f} % folded"
        if no_folds:
            said = f"in {map.report().steps} steps: {100 * folded(map, x, faces):.1f} % folded"
        panels.append(Panel(said, map.at(x), faces, colours=sample.colours))
    render(panels, folder / "no-folds-chair.png", control_points=points, width=1400)

    x, faces = bar()
    ends = nm.ControlPoints([[0.0, 0, 0], [0, 4, 0]], names=["low", "high"])
    twisted = ends.oriented({"low": nm.Orientation((0, 1, 0), 0), "high": nm.Orientation((0, 1, 0), TURNS)})
    panels = [Panel("at rest", x, faces)]
    for no_folds in (False, True):
        map = nm.Session(twisted, no_folds=no_folds).fit(x, faces=faces)
        title = f"in {map.report().steps} steps" if no_folds else "in one step"
        panels.append(Panel(f"turned by {TURNS}, {title}", map.at(x), faces))
    render(panels, folder / "no-folds-twist.png", control_points=ends, width=1200)


def folded(map: nm.Map, x: Array, faces: NDArray[np.int64]) -> float:
    """The part of the shape where space is turned inside out."""
    return float((map.look(x, faces).determinants <= 0).mean())


def bar() -> tuple[Array, NDArray[np.int64]]:
    """A square bar along y, 4 x 0.6 x 0.6."""
    corner = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * 0.3
    side = np.linspace(0, 1, 12, endpoint=False)[:, None]
    ring = np.concatenate([a + side * (b - a) for a, b in zip(corner, np.roll(corner, -1, axis=0), strict=True)])
    x = np.concatenate([np.column_stack([ring[:, 0], np.full(48, y), ring[:, 1]]) for y in np.linspace(0, 4, 161)])
    a = 48 * np.arange(160)[:, None] + np.arange(48)
    b = 48 * np.arange(160)[:, None] + (np.arange(48) + 1) % 48
    return x, np.concatenate([np.stack(f, axis=2).reshape(-1, 3) for f in ([a, b + 48, b], [a, a + 48, b + 48])])


if __name__ == "__main__":
    main(Path(sys.argv[1]))
