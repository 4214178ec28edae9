"""Chooses the settings of shape-aware weights, once for all shapes: `python studies/shape_aware.py RESULT.json`.

Creatures made by code (creatures.py) are moved to true poses by 12 and 40 control points. What a setting scores is the
geometric mean over creatures of its mean error, divided by that of the best of RBF, classic MLS (1/d^4) and ARAP on
that creature. Weights come straight from the formula, without a network. The creatures for "tuning" are of other seeds,
and of fewer kinds, than those for "checking". In free poses every joint bends by itself, in paired ones left and right
bend much alike.
"""

from __future__ import annotations

import json
import sys
from dataclasses import dataclass
from itertools import product
from pathlib import Path

import numpy as np
from creatures import Array, creature, free, paired
from numpy.typing import ArrayLike, NDArray

from neuralmls import Deformer, NotApplicable
from neuralmls.experiments.poses import POSE_METHODS, Poses, pose_errors
from neuralmls.placement import farthest_of
from neuralmls.weights import shape_aware
from neuralmls.weights.surface_graph import Reach, SurfaceGraph

COUNTS = (12, 40)
RIVALS = ("rbf", "classic", "arap")
FREE, PAIRED = ("four-legged", "two-legged", "octopus", "chair"), ("four-legged", "two-legged", "clothed")
GROUPS = {
    "tuning, free": [(kind, seed, free) for kind in FREE for seed in (1, 2)],
    "tuning, paired": [(kind, seed, paired) for kind in PAIRED for seed in (1, 2)],
    "checking, free": [(kind, 3, free) for kind in FREE] + [("hand", seed, free) for seed in (1, 2)],
    "checking, paired": [(kind, seed, paired) for kind in PAIRED for seed in (3, 4)],
}
SETTINGS = list(product((1.5, 2.0, 2.5, 3.0), (4.0, 8.0, np.inf), (0.0, 0.5, 0.75, 1.0, np.inf)))  # power, kept, reach


class Given:
    """Logits at the vertices, as a weight function."""

    def __init__(self, control_points: Array, logits: Array) -> None:
        self.control_points, self._logits = control_points, logits

    def logits(self, x: ArrayLike, *, progress: object = None) -> NDArray[np.float32]:  # noqa: ARG002
        return self._logits.astype(np.float32)


@dataclass(frozen=True)
class Found:
    """What a `SurfaceGraph` found for one set of control points, at the vertices."""

    nodes: Array
    met: Array
    along: Reach

    def first_met(self, _: Array, __: Reach) -> Array:
        return self.met

    def reach(self, _: Array) -> Reach:
        return self.along


def setting_errors(poses: Poses, count: int) -> dict[str, float]:
    """The mean error of each setting, in % of the diagonal."""
    x = poses.rest.positions
    low, high = x.min(axis=0), x.max(axis=0)
    unit = (x - (low + high) / 2) / ((high - low).max() / 2)
    chosen = farthest_of(x, count)
    graph = SurfaceGraph(unit, poses.rest.faces)
    nodes = graph.nearest(unit)
    along = graph.reach(unit[chosen])
    met = graph.first_met(unit[chosen], along)
    found = Found(unit, met[nodes], Reach(along.far[nodes], along.nearest[nodes], along.apart))
    errors = {}
    for power, kept, reach in SETTINGS:
        logits = shape_aware.shape_logits(found, unit[chosen], power=power, kept=kept, reach=reach)
        deformer = Deformer(x, Given(x[chosen], logits))
        off = [np.linalg.norm(deformer.deform(pose[chosen]) - pose, axis=1).mean() for pose in poses.poses]
        errors[f"power {power:g}, kept {kept:g}, reach {reach:g}"] = 100 * float(
            np.mean(off) / np.linalg.norm(high - low)
        )
    return errors


def rival_errors(poses: Poses, count: int) -> dict[str, float]:
    """The mean error of each rival that can do the shape."""
    errors = {}
    for name in RIVALS:
        try:
            errors[name] = round(float(np.mean(pose_errors(poses, POSE_METHODS[name], count))), 4)
        except NotApplicable:
            continue
    return errors


def main(result: Path) -> None:
    """Run the study and write what came out."""
    cases = []
    for group, members in GROUPS.items():
        for (kind, seed, turned), count in product(members, COUNTS):
            poses = creature(kind, seed, turned)
            case = {"group": group, "creature": poses.name, "control_points": count}
            case |= {"rivals": rival_errors(poses, count), "settings": setting_errors(poses, count)}
            cases.append(case)
            print(group, poses.name, count, flush=True)
    scores = {}
    for setting in cases[0]["settings"]:
        for group, count in product(GROUPS, COUNTS):
            ratios = [
                case["settings"][setting] / min(case["rivals"].values())
                for case in cases
                if (case["group"], case["control_points"]) == (group, count)
            ]
            scores.setdefault(setting, {})[f"{group}, {count}"] = round(float(np.exp(np.mean(np.log(ratios)))), 4)
    for case in cases:
        case["settings"] = [round(error, 4) for error in case["settings"].values()]  # in the order of the scores
    lines = ",\n".join(json.dumps(case) for case in cases)
    result.write_text(f'{{"scores": {json.dumps(scores, indent=1)},\n"cases": [\n{lines}\n]}}\n')
    for setting, score in scores.items():
        print(f"{setting:32}", *(f"{name}: {value:.3f}" for name, value in score.items()))


if __name__ == "__main__":
    main(Path(sys.argv[1]))
