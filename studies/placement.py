"""What placement is worth: `python studies/placement.py POSES [COUNT ...]`.

Each file of true poses is moved by control points that `neuralmls.place` chose, and by as many farthest points, both
brought to the nearest vertices, for whose motion is known. The mean error over all vertices, in % of the diagonal, is
divided by that with farthest points; the last lines are the geometric means over the files.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from neuralmls import farthest_of, place
from neuralmls.errors import ArgumentError
from neuralmls_research.experiments.methods import Array, Method, neural, shape_aware
from neuralmls_research.experiments.poses import Poses, read_poses

COUNTS = (8, 12, 16, 20)
METHODS = {"neural": neural(), "shape-aware": shape_aware()}
WISHES = {"placed": {}, "symmetric": {"symmetric": True}}
MOST = 4  # poses of a file, spread evenly over it


def mean_error(poses: Poses, method: Method, chosen: Array) -> float:
    """In % of the diagonal of the rest shape's box, where the vertices `chosen` are the control points."""
    x = poses.rest.positions
    bound = method.bind(poses.rest, x[chosen])
    which = np.unique(np.linspace(0, len(poses.poses) - 1, MOST).astype(int))
    off = [np.linalg.norm(bound.positions(pose[chosen]) - pose, axis=1).mean() for pose in poses.poses[which]]
    return 100 * float(np.mean(off) / np.linalg.norm(np.ptp(x, axis=0)))


def placed(poses: Poses, count: int, **wish: bool) -> Array:
    """Return the vertices nearest to the placed points, as many."""
    x = poses.rest.positions
    points = place(x, poses.rest.faces, count, **wish).points.sources
    chosen = np.array([np.linalg.norm(x - point, axis=1).argmin() for point in points])
    if len(np.unique(chosen)) < count:
        raise ArgumentError(f"{poses.name}: two of the points are at one vertex")
    return chosen


def main(folder: Path, counts: tuple[int, ...]) -> None:
    """Run the study and print what came out."""
    ratios: dict[tuple[str, str, int], list[float]] = {}
    for path in sorted(folder.glob("*.npz")):
        poses = read_poses(path)
        for count in counts:
            sets = {"farthest": farthest_of(poses.rest.positions, count)}
            for name, wish in WISHES.items():
                try:
                    sets[name] = placed(poses, count, **wish)
                except ArgumentError:  # not symmetric
                    continue
            for method_name, method in METHODS.items():
                errors = {name: mean_error(poses, method, chosen) for name, chosen in sets.items()}
                for name in errors.keys() - {"farthest"}:
                    ratios.setdefault((name, method_name, count), []).append(errors[name] / errors["farthest"])
                told = ", ".join(f"{name} {error:.3f}" for name, error in errors.items())
                print(f"{poses.name}, {count} points, {method_name}: {told}", flush=True)
    for (name, method_name, count), each in sorted(ratios.items()):
        mean = np.exp(np.mean(np.log(each)))
        print(f"{name}, {method_name}, {count} points: {mean:.3f} of farthest ({len(each)} files)")


if __name__ == "__main__":
    main(Path(sys.argv[1]), tuple(int(count) for count in sys.argv[2:]) or COUNTS)
