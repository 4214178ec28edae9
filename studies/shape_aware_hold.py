"""How firmly a control point holds the shape, on true poses: `python studies/shape_aware_hold.py FILE.npz...`.

Weights come straight from the formula, without a network, and control points are vertices. Mean error in % of the
diagonal, and the geometric mean over the files for 12 and 40 control points.
"""

from __future__ import annotations

import sys
from itertools import product

import numpy as np
from shape_aware import Found, Given
from shape_logits import shape_logits
from surface_graph import Reach, SurfaceGraph

import neuralmls as nm
from neuralmls_research.experiments.poses import MOST, read_poses

COUNTS = (12, 40)
SETTINGS = [(hold, held) for hold, held in product((0.6, 0.8, 1.2), (0.25, 0.5, 1.0))]


def errors(path: str, count: int) -> list[float]:
    """The mean error of each setting."""
    poses = read_poses(path)
    x = poses.rest.positions
    low, high = x.min(axis=0), x.max(axis=0)
    unit = (x - (low + high) / 2) / ((high - low).max() / 2)
    chosen = nm.farthest_of(x, count)
    graph = SurfaceGraph(unit, poses.rest.faces)
    nodes, along = graph.nearest(unit), graph.reach(unit[chosen])
    reach = Reach(along.far[nodes], along.nearest[nodes], along.apart)
    distances = graph.distances(unit[chosen])[nodes]
    few = np.unique(np.linspace(0, len(poses.poses) - 1, MOST).astype(int))
    found = []
    for hold, held in SETTINGS:
        met = graph.first_met(unit[chosen], along, hold=hold, held=held)[nodes]
        whole = Found(unit, met, reach)
        logits = shape_logits(whole, unit[chosen], distances=distances)  # type: ignore[arg-type]
        deformer = nm.Deformer(x, Given(x[chosen], logits))
        off = [np.linalg.norm(deformer.deform(poses.poses[k][chosen]) - poses.poses[k], axis=1).mean() for k in few]
        found.append(100 * float(np.mean(off) / np.linalg.norm(high - low)))
    return found


def main(paths: list[str]) -> None:
    """Print a line a setting."""
    for count in COUNTS:
        table = np.array([errors(path, count) for path in paths])
        for (hold, held), of_one in zip(SETTINGS, table.T, strict=True):
            mean = np.exp(np.log(of_one).mean())
            print(f"{count} points, hold {hold:g}, held {held:g}: {mean:.4f}", *of_one.round(3))


if __name__ == "__main__":
    main(sys.argv[1:])
