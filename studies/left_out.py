"""When affine maps would follow many control points far more closely: `python -m studies.left_out SHAPE POSES.npz ...`.

Each control point is left out of its own weights and taken along by the others, with rigid and with affine maps; beside
it stands what the shape itself says, of which the control points are a part. 50 to 400 points of SHAPE follow a smooth
motion, its lower half pulled longer, and its upper half turned; 50 to 200 points of each file of poses (`rest` (n, 3),
`poses` (k, n, 3)) follow two poses. All handles are exact but where one is left out. Prints a table: medians and root
mean squares of affine maps in those of rigid ones, left out and on the shape, and thin plates on the shape.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import RBFInterpolator  # type: ignore[import-untyped]

import neuralmls as nm
from studies.many_points import normalised, smooth

Array = NDArray[np.float64]
NOTHING = -1e30


class Others:
    """Weights at the control points, each of which says nothing of its own place."""

    def __init__(self, weights: nm.Weights) -> None:
        self.control_points = weights.control_points
        self._logits = weights.logits(self.control_points)
        np.fill_diagonal(self._logits, NOTHING)

    def logits(self, x: ArrayLike, *, progress: object = None) -> NDArray[np.float32]:
        """Its logits at the control points, (m, m)."""
        del x, progress  # they are known already
        return self._logits


def longer(x: Array) -> Array:
    """The lower half pulled to half as much again."""
    return np.stack([x[:, 0], np.where(x[:, 1] < 0, 1.5 * x[:, 1], x[:, 1]), x[:, 2]], axis=1)


def leaned(x: Array) -> Array:
    """The upper half turned by 30 degrees about x."""
    sin, cos = np.sin(np.pi / 6), np.cos(np.pi / 6)
    _, y, z = x.T
    return np.where(y[:, None] > 0, np.stack([x[:, 0], cos * y - sin * z, sin * y + cos * z], axis=1), x)


def motions(shape: Path, files: list[Path]) -> Iterator[tuple[str, Array, Array, Array, Array]]:
    """A title, control points at rest and moved, places at rest and moved."""
    positions = normalised(found := np.asarray(nm.read(shape).positions), found)
    x = positions[np.random.default_rng(9).choice(len(positions), 3000)]
    for count in (50, 100, 200, 400):
        p = positions[nm.farthest_of(positions, count)]
        for move in (smooth, longer, leaned):
            yield f"{move.__name__}, {count}", p, move(p), x, move(x)
    for path in files:
        with np.load(path, allow_pickle=False) as stored:
            rest, poses = (stored[name].astype(np.float64) for name in ("rest", "poses"))
        chosen = poses[np.linspace(0, len(poses) - 1, 3).astype(int)[1:]]
        rest, chosen = normalised(rest, rest), normalised(chosen, rest)
        looked_at = np.random.default_rng(3).choice(len(rest), min(len(rest), 3000), replace=False)
        for count in (50, 100, 200):
            at = nm.farthest_of(rest, count)
            for number, pose in enumerate(chosen):
                yield f"{path.stem} {number}, {count}", rest[at], pose[at], rest[looked_at], pose[looked_at]


def both(away: Array) -> Array:
    """The median and the root mean square of distances."""
    lengths = np.linalg.norm(away, axis=1)
    return np.array([np.median(lengths), np.sqrt((lengths**2).mean())])


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("shape", type=Path)
    parser.add_argument("poses", type=Path, nargs="*")
    given = parser.parse_args()
    makers = {
        "neural": lambda p: nm.NeuralWeights.fit(p, bounds=[[-1] * 3, [1] * 3]),
        "inverse distance, 1/d^2": lambda p: nm.InverseDistanceWeights(p, alpha=1),
        "inverse distance, 1/d^4": lambda p: nm.InverseDistanceWeights(p, alpha=2),
    }
    ratios = "affine in rigid, left out | on the shape | rigid, on the shape, in neural | left out in on the shape"
    print(f"| motion, control points | weights | {ratios} |")
    for title, p, q, x, y in motions(given.shape, given.poses):
        neural = None
        for name, make in makers.items():
            weights = make(p)
            out, on = [], []
            for transform in ("rigid", "affine"):
                others = nm.Deformer(p, Others(weights), transform=transform)  # type: ignore[arg-type]
                out.append(both(others.deform(q) - q))
                on.append(both(nm.Deformer(x, weights, transform=transform).deform(q, adherence=1.0) - y))  # type: ignore[arg-type]
            neural = on[0] if neural is None else neural
            cells = (out[1] / out[0], on[1] / on[0], on[0] / neural, out[0] / on[0])
            print(f"| {title} | {name} | {' | '.join(f'{a:.2f}, {b:.2f}' for a, b in cells)} |", flush=True)
        plate = x + RBFInterpolator(p, q - p, kernel="linear", degree=1)(x)
        ratio = both(plate - y) / neural
        print(f"| {title} | thin plate | | | {ratio[0]:.2f}, {ratio[1]:.2f} | |", flush=True)


if __name__ == "__main__":
    main()
