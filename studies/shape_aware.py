"""Chooses the settings of shape-aware weights, once for all shapes: `python studies/shape_aware.py RESULT.json`.

Creatures made by code (creatures.py) are moved to true poses by 12 and 40 control points, on the surface and inside of
it. What a setting scores is the geometric mean over creatures of its mean error, divided by that of the best of RBF,
classic MLS (1/d^4) and ARAP on that creature, moved by those on the surface. Weights come straight from the formula,
without a network. The creatures for "tuning" are of other seeds, and of fewer kinds, than those for "checking". In free
poses every joint bends by itself, in paired ones left and right bend much alike.
"""

from __future__ import annotations

import json
import sys
from dataclasses import asdict, dataclass, replace
from functools import cache
from itertools import product
from pathlib import Path

import numpy as np
import shape_logits
import surface_graph
from creatures import Array, creature, free, inside, paired
from numpy.typing import ArrayLike, NDArray
from surface_graph import Reach, SurfaceGraph

from neuralmls import Deformer, NotApplicable, farthest_of
from neuralmls_research.experiments.poses import POSE_METHODS, Poses, pose_errors

COUNTS = (12, 40)
RIVALS = ("rbf", "classic", "arap")
FREE, PAIRED = ("four-legged", "two-legged", "octopus", "chair"), ("four-legged", "two-legged", "clothed")
GROUPS = {
    "tuning, free": [(kind, seed, free) for kind in FREE for seed in (1, 2)],
    "tuning, paired": [(kind, seed, paired) for kind in PAIRED for seed in (1, 2)],
    "checking, free": [(kind, 3, free) for kind in FREE] + [("hand", seed, free) for seed in (1, 2)],
    "checking, paired": [(kind, seed, paired) for kind in PAIRED for seed in (3, 4)],
}
PLACES = ("on", "inside")  # where control points are


@dataclass(frozen=True)
class Setting:
    """What is chosen; as it was chosen unless said."""

    power: float = shape_logits.POWER
    kept: float = shape_logits.KEPT
    reach: float = shape_logits.REACH
    hold: float = surface_graph.HOLD
    held: float = surface_graph.HELD
    around: float = surface_graph.AROUND

    def __str__(self) -> str:
        return ", ".join(f"{name} {value:g}" for name, value in asdict(self).items())


CHOSEN = Setting()
SETTINGS = [
    *(Setting(*each) for each in product((1.5, 2.0, 2.5, 3.0), (4.0, 8.0, np.inf), (0.0, 0.5, 0.75, 1.0, np.inf))),
    *(
        replace(CHOSEN, power=power, hold=hold, held=held)
        for power, hold, held in product((2.0, 2.5, 3.0), (0.8, 1.2, 1.6), (1.0, 2.0, 4.0, 8.0))
        if (hold, held) != (CHOSEN.hold, CHOSEN.held)
    ),
    *(replace(CHOSEN, around=around) for around in (1.5, 3.0, 4.0)),
]


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


def setting_errors(poses: Poses, p: Array, moved: Array) -> list[float]:
    """The mean error of each setting, in % of the diagonal, where control points `p` (m, 3) are moved (k, m, 3)."""
    x = poses.rest.positions
    low, high = x.min(axis=0), x.max(axis=0)
    centre, half = (low + high) / 2, (high - low).max() / 2
    unit, at = (x - centre) / half, (p - centre) / half
    graph = SurfaceGraph(unit, poses.rest.faces)
    nodes = graph.nearest(unit)

    @cache
    def along(around: float) -> Reach:
        return graph.reach(at, around=around)

    @cache
    def found(around: float, hold: float, held: float) -> Found:
        reach = along(around)
        met = graph.first_met(at, reach, hold=hold, held=held)[nodes]
        return Found(unit, met, Reach(reach.far[nodes], reach.nearest[nodes], reach.apart))

    errors = []
    for each in SETTINGS:
        graph_found = found(each.around, each.hold, each.held)
        logits = shape_logits.shape_logits(graph_found, at, power=each.power, kept=each.kept, reach=each.reach)
        deformer = Deformer(x, Given(p, logits))
        pairs = zip(moved, poses.poses, strict=True)
        off = [np.linalg.norm(deformer.deform(q) - pose, axis=1).mean() for q, pose in pairs]
        errors.append(round(100 * float(np.mean(off) / np.linalg.norm(high - low)), 4))
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
            chosen = farthest_of(poses.rest.positions, count)
            case = {"group": group, "creature": poses.name, "control_points": count}
            case |= {"rivals": rival_errors(poses, count)}
            case["on"] = setting_errors(poses, poses.rest.positions[chosen], poses.poses[:, chosen])
            case["inside"] = setting_errors(poses, *inside(kind, seed, turned, chosen))
            cases.append(case)
            print(group, poses.name, count, flush=True)
    scores: dict[str, dict[str, float]] = {str(each): {} for each in SETTINGS}
    for (group, count), place in product(product(GROUPS, COUNTS), PLACES):
        them = [case for case in cases if (case["group"], case["control_points"]) == (group, count)]
        ratios = np.log([np.divide(case[place], min(case["rivals"].values())) for case in them])
        for score, ratio in zip(scores.values(), np.exp(ratios.mean(axis=0)), strict=True):
            score[f"{group}, {place}, {count}"] = round(float(ratio), 4)
    # In a case, the settings are in the order of the scores.
    text = ",\n".join(f"{json.dumps(name)}: {json.dumps(score)}" for name, score in scores.items())
    lines = ",\n".join(json.dumps(case) for case in cases)
    result.write_text(f'{{"scores": {{\n{text}\n}},\n"cases": [\n{lines}\n]}}\n')
    for name, score in scores.items():
        print(name, *(f"{value:.3f}" for value in score.values()))


if __name__ == "__main__":
    main(Path(sys.argv[1]))
