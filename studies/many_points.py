"""What the closed form of many control points is worth: `python -m studies.many_points SHAPE POSES.npz ...`, a minute.

A NumPy version of crates/core/src/weights/network/prototypes.rs is swept over its sharpness and over the weight to
which control points are lifted. 200 points of SHAPE follow a smooth motion, beside the thin plate; 100 points of each
file of poses (`rest` (n, 3), `poses` (k, n, 3)) follow four poses. All handles are exact. Prints a table.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import RBFInterpolator  # type: ignore[import-untyped]

import neuralmls as nm

Array = NDArray[np.float64]
WIDTH = 1024
RIDGE = 5e-8
ROUNDS = 12
SETTINGS = [(0.5, 0.5), (0.5, 0.9), (1.0, 0.9), (2.0, 0.5), (2.0, 0.9), (4.0, 0.9)]


class Given:
    """A weight function by its logits."""

    def __init__(self, control_points: Array, function: Callable[[Array], Array]) -> None:
        self.control_points = control_points
        self._function = function

    def logits(self, x: ArrayLike, *, progress: object = None) -> NDArray[np.float32]:
        """Its logits at the points `x`, (n, m)."""
        del progress  # there is none to tell
        return np.ascontiguousarray(self._function(np.asarray(x)), np.float32)


def closed_form(p: Array, sharpness: float, lifted: float) -> Given:
    """Prototypes of random hidden layers, each lifted until it has so much of the weight at its own place."""
    rng = np.random.default_rng(0)
    layers = [(rng.uniform(-1, 1, (n, WIDTH)) / np.sqrt(n), rng.uniform(-1, 1, WIDTH) / np.sqrt(n)) for n in (3, WIDTH)]

    def hidden(x: Array) -> Array:
        for weight, bias in layers:
            x = np.maximum(x @ weight + bias, 0)
        return x

    mean = hidden(p).mean(axis=0)
    h = hidden(p) - mean
    squares = (h**2).sum(axis=1)
    distances = squares[:, None] + squares - 2 * h @ h.T
    np.fill_diagonal(distances, np.inf)
    a = sharpness / np.median(distances.min(axis=1))
    weight, bias = a * h, -a / 2 * squares
    kernel = np.linalg.inv(h @ h.T + 1 + RIDGE * np.eye(len(p)))
    for _ in range(ROUNDS):
        own = np.diagonal(nm.softmax((h @ weight.T + bias).astype(np.float32)))
        missing = np.maximum(0, np.log(lifted / (1 - lifted)) - np.log(own / (1 - own)))
        change = kernel * missing
        weight, bias = weight + change.T @ h, bias + change.sum(axis=0)
    return Given(p, lambda x: (hidden(x) - mean) @ weight.T + bias)


def smooth(x: Array) -> Array:
    """A motion without a kink."""
    a, b, c = x.T
    move = [np.sin(b) + 0.3 * np.cos(c), np.sin(c + 0.5) - 0.4 * np.sin(a), np.cos(a + 0.3) + 0.3 * b]
    return x + 0.1 * np.stack(move, axis=1)


def normalised(x: Array, by: Array) -> Array:
    """Coordinates about the middle of the box of `by`, half of whose longest side is 1."""
    low, high = by.min(axis=0), by.max(axis=0)
    return np.asarray((x - (low + high) / 2) / ((high - low).max() / 2))


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("shape", type=Path)
    parser.add_argument("poses", type=Path, nargs="*")
    given = parser.parse_args()
    positions = np.asarray(nm.read(given.shape).positions)
    shape = normalised(positions, positions)
    x = shape[np.random.default_rng(9).choice(len(shape), 5000)]
    p = shape[np.random.default_rng(1).choice(len(shape), 200, replace=False)]
    size = np.median(np.linalg.norm(smooth(x) - x, axis=1))
    plate = x + RBFInterpolator(p, smooth(p) - p, kernel="linear", degree=1)(x)

    def error(y: NDArray[Any]) -> str:
        return f"{np.median(np.linalg.norm(y - smooth(x), axis=1)) / size:.5f}"

    animations = []
    for path in given.poses:
        with np.load(path, allow_pickle=False) as stored:
            rest, poses = (stored[name].astype(np.float64) for name in ("rest", "poses"))
        chosen = poses[np.linspace(0, len(poses) - 1, 4).astype(int)]
        animations.append((normalised(rest, rest), normalised(chosen, rest), nm.farthest_of(rest, 100)))

    def row(title: str, make: Callable[[Array, Array], nm.Weights | Given]) -> None:
        weights = make(p, shape)
        cells = []
        for transform in ("rigid", "affine"):
            cells.append(error(nm.Deformer(x, weights, transform=transform).deform(smooth(p), adherence=1.0)))
        for rest, poses, at in animations:
            deformer = nm.Deformer(rest, make(rest[at], rest))
            away = [np.linalg.norm(deformer.deform(pose[at], adherence=1.0) - pose, axis=1).mean() for pose in poses]
            cells.append(f"{np.mean(away) / 2:.5f}")
        print(f"| {title} | {' | '.join(cells)} |", flush=True)

    print(f"thin plate {error(plate)}\n| weights | smooth, rigid | smooth, affine | poses, part of the side ... |")
    row("inverse distance, 1/d^4", lambda p, _: nm.InverseDistanceWeights(p, alpha=2))
    row("neural, default", lambda p, x: nm.NeuralWeights.fit(p, bounds=[x.min(axis=0), x.max(axis=0)]))
    for setting in SETTINGS:
        row("sharpness {}, lifted to {}".format(*setting), lambda p, _, by=setting: closed_form(p, *by))  # type: ignore[misc]


if __name__ == "__main__":
    main()
