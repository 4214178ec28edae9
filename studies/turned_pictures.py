"""The pictures of turned control points in docs/notes/beyond-the-paper.md: `python studies/turned_pictures.py FOLDER`."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

import neuralmls as nm
from neuralmls import ControlPoints
from neuralmls.figures.render import Panel, render
from neuralmls.samples import make

# What is turned, about which axis, by how many degrees.
CHAIR = {
    "at rest": {},
    "an armrest by 40": {"armrest-left": ((0, 1, 0), 40)},
    "both armrests, the back's top": {
        "armrest-left": ((0, 1, 0), -35),
        "armrest-right": ((0, 1, 0), 35),
        "back-top-left": ((1, 0, 0), -30),
        "back-top-right": ((1, 0, 0), -30),
    },
}
BAR = {
    "at rest": {},
    "ends by -45 and 45": {"low": -45, "high": 45},
    "-85 and 85: a crease": {"low": -85, "high": 85},
    "the same, the middle held": {"low": -85, "middle": 0, "high": 85},
}


def main(folder: Path) -> None:
    """Draw the chair and the bar."""
    sample = make("chair")
    x, points = sample.vertices, ControlPoints(sample.control_points.sources, names=sample.control_points.names)
    panels = []
    for title, turns in CHAIR.items():
        held = points.oriented({name: nm.Orientation(axis, degrees) for name, (axis, degrees) in turns.items()})
        panels.append(Panel(title, deformed(x, held), sample.triangles, colours=sample.colours))
    render(panels, folder / "turned-chair.png", control_points=points, width=1400)

    x, faces = bar()
    panels = []
    for title, degrees in BAR.items():
        places = {"low": 0.0, "middle": 0.5, "high": 1.0}
        names = [name for name in places if name in degrees or name != "middle"]
        held = ControlPoints([[0, places[name], 0] for name in names], names=names)
        held = held.oriented({name: nm.Orientation((0, 1, 0), angle) for name, angle in degrees.items()})
        panels.append(Panel(title, deformed(x, held), faces))
    render(panels, folder / "twisted-bar.png", control_points=ControlPoints([[0, 0, 0], [0, 1, 0]]), width=1200)


def deformed(x: np.ndarray, points: ControlPoints) -> np.ndarray:
    """Where the points go, exactly and rigidly."""
    return nm.deform(
        x, points.sources, points.targets, rotations=points.rotations, scales=points.scales, handles="exact"
    )


def bar() -> tuple[np.ndarray, np.ndarray]:
    """A square bar along y: vertices (n, 3) and triangles."""
    around, along = 4 * 12, 241
    s = np.linspace(0, 4, around, endpoint=False)
    corner, within = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]), (s % 1)[:, None]
    side = corner[s.astype(int)] * (1 - within) + corner[(s.astype(int) + 1) % 4] * within
    y = np.repeat(np.linspace(0, 1, along), around)
    x = np.column_stack([np.tile(0.09 * side[:, 0], along), y, np.tile(0.09 * side[:, 1], along)])
    i, j = np.meshgrid(np.arange(along - 1), np.arange(around), indexing="ij")
    a, b = (i * around + j).ravel(), (i * around + (j + 1) % around).ravel()
    return x, np.concatenate([np.column_stack([a, a + around, b]), np.column_stack([b, a + around, b + around])])


if __name__ == "__main__":
    main(Path(sys.argv[1]))
