"""The pictures of docs/notes/beyond-the-paper.md: `python studies/pictures.py FOLDER`."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from creatures import creature

from neuralmls import ControlPoints, farthest_of
from neuralmls.figures.render import Panel, render
from neuralmls_research.experiments.methods import METHODS

# A creature, how many control points, which of its poses.
PICTURES = {
    "shape-aware-person": ("two-legged", 2, 40, 0),
    "shape-aware-hand": ("hand", 1, 40, 0),
    "shape-aware-four-legged": ("four-legged", 1, 12, 1),
}


def main(folder: Path) -> None:
    """Draw the true pose beside what the methods make of it."""
    for name, (kind, seed, count, number) in PICTURES.items():
        poses = creature(kind, seed)
        x, pose = poses.rest.positions, poses.poses[number]
        chosen = farthest_of(x, count)
        diagonal = np.linalg.norm(np.ptp(x, axis=0))
        panels = [Panel("true pose", pose, poses.rest.faces)]
        for method in ("neural", "shape-aware-exact"):
            y = METHODS[method](poses.rest, x[chosen], pose[chosen])
            error = 100 * np.linalg.norm(y - pose, axis=1).mean() / diagonal
            panels.append(Panel(f"{METHODS[method].title}: {error:.2f} % off", y, poses.rest.faces))
        held = ControlPoints(pose[chosen], pose[chosen])
        render(panels, folder / f"{name}.png", control_points=held, width=900, up="z", azimuth=70)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
