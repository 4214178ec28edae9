"""Whether a measure of both results could choose between neural and shape-aware weights: `python
studies/edits_choice.py DATA`, some minutes.

A rule takes neural weights where shape-aware ones are worse by its measure and a margin: over all edits (edit_cases.py)
and all poses of the sequences in DATA/poses, 12 and 40 control points. What it loses against the better of the two is
by strain and by `spoilt` on edits, and by the distance to the truth on poses.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from itertools import product
from pathlib import Path

import numpy as np
from edit_cases import edits
from edits import HARDLY, OURS, RUN, Bench, results_of, strained

import neuralmls as nm
from neuralmls_research.experiments.poses import MOST, read_poses
from neuralmls_research.metrics import Bends

COUNTS = (12, 40)
MEASURES = ("strain", "spoilt")
MARGINS = (1.05, 1.08, 1.1, 1.15, np.inf)  # without limit: always shape-aware
LIMIT = 1.05


@dataclass(frozen=True)
class Both:
    """What both kinds of weights make of one edit or pose, by the measures, and off the truth where there is one."""

    group: str
    neural: dict[str, float]
    aware: dict[str, float]

    def chosen(self, measure: str, margin: float) -> dict[str, float]:
        """The rule's choice."""
        return self.neural if self.aware[measure] > margin * self.neural[measure] else self.aware


def lost(them: list[Both], measure: str, margin: float, by: str) -> float:
    """What the rule's choices are of the better of the two, in the mean over some edits or poses."""
    chosen = sum(each.chosen(measure, margin)[by] for each in them)
    least = min(sum(each.neural[by] for each in them), sum(each.aware[by] for each in them))
    return chosen / least if least > 0 else 1.0


def of_edits(data: Path) -> list[Both]:
    """The edits."""
    bench, found = Bench({name: RUN[name] for name in OURS}), []
    for edit in edits(data):
        results = results_of(bench.results(edit))
        found.append(Both("edits", *({name: getattr(results[kind], name) for name in MEASURES} for kind in OURS)))
    return found


def of_poses(path: Path, count: int) -> list[Both]:
    """The poses of a sequence."""
    poses, found = read_poses(path), []
    x, faces = poses.rest.positions, poses.rest.faces
    chosen, bends = nm.farthest_of(x, count), Bends(x, faces)
    bound = [RUN[kind].bind(poses.rest, x[chosen]) for kind in OURS]
    for number in np.linspace(0, len(poses.poses) - 1, min(MOST, len(poses.poses))).astype(int):
        pose, both = poses.poses[number], []
        for each in bound:
            y = each.positions(pose[chosen])
            strain = strained(x, y, faces)
            off = float(np.linalg.norm(y - pose, axis=1).mean())
            both.append({"strain": strain, "spoilt": np.sqrt(strain * (bends.bent(y) + HARDLY)), "off": off})
        found.append(Both(f"{poses.name}, {count}", *both))
    return found


def main(data: Path) -> None:
    """Print a line a rule."""
    edited = of_edits(data)
    posed = [
        pose for path in sorted((data / "poses").glob("*.npz")) for count in COUNTS for pose in of_poses(path, count)
    ]
    sequences = [
        [pose for pose in posed if pose.group == group] for group in dict.fromkeys(pose.group for pose in posed)
    ]
    for measure, margin in product(MEASURES, MARGINS):
        losses = {
            "edits by strain": [lost([edit], measure, margin, "strain") for edit in edited],
            "edits by spoilt": [lost([edit], measure, margin, "spoilt") for edit in edited],
            "poses": [lost([pose], measure, margin, "off") for pose in posed],
            "sequences": [lost(poses, measure, margin, "off") for poses in sequences],
        }
        said = [
            f"{name}: {sum(each > LIMIT for each in found)} of {len(found)} lose over 5 %, at most {max(found):.2f}"
            for name, found in losses.items()
        ]
        print(f"{measure}, margin {margin:g}: {'; '.join(said)}")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
