"""What everything is timed on: points on the sample chair, ten control points, a trained network of width 1024."""

from __future__ import annotations

import tempfile
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from safetensors import safe_open
from safetensors.numpy import load_file, save_file

import neuralmls as nm
from neuralmls import samples

Array = NDArray[np.float64]
Single = NDArray[np.float32]

SEED = 0


@dataclass(frozen=True)
class Chair:
    """The sample chair with ten of its control points, moved: longer legs, a leaning back."""

    vertices: Array
    triangles: NDArray[np.int64]
    bounds: Array
    p: Array
    q: Array


@dataclass(frozen=True)
class Network:
    """A trained network's parameters as NumPy arrays: weights (out, in) and biases of its three layers."""

    centre: Array
    half: float
    layers: list[tuple[Single, Single]]


class Given:
    """A weight function whose logits are known already: a frame is then timed and checked without the network."""

    def __init__(self, control_points: Array, logits: Single) -> None:
        self.control_points = control_points
        self._logits = logits

    def logits(self, _x: object, *, progress: object = None) -> Single:
        """The logits given."""
        return self._logits


@cache
def chair() -> Chair:
    """The chair. Its armrests' control points are left out: ten remain."""
    sample = samples.make("chair")
    points = sample.control_points
    chosen = [i for i, name in enumerate(points.names) if not name.startswith("armrest")]
    x = sample.vertices
    bounds = np.stack([x.min(axis=0), x.max(axis=0)])
    return Chair(x, sample.triangles, bounds, points.sources[chosen], points.targets[chosen])


@cache
def surface(count: int) -> Array:
    """`count` points on the chair, spread by area, in no order."""
    shape = chair()
    rng = np.random.default_rng(SEED)
    a, b, c = (shape.vertices[shape.triangles[:, i]] for i in range(3))
    areas = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    at = rng.choice(len(areas), count, p=areas / areas.sum())
    s, t = rng.random((2, count, 1))
    s, t = np.where(s + t > 1, 1 - s, s), np.where(s + t > 1, 1 - t, t)
    points: Array = a[at] + s * (b[at] - a[at]) + t * (c[at] - a[at])
    points.flags.writeable = False
    return points


def tree(x: Array) -> nm.PointTree:
    """The tree of points on the chair, measured by its box."""
    return nm.PointTree(x, bounds=chair().bounds)


def subset(count: int, of: int) -> NDArray[np.intp]:
    """Which points are checked."""
    return np.random.default_rng(SEED + 1).permutation(of)[:count]


@cache
def weights(count: int = 10, width: int = 1024) -> nm.NeuralWeights:
    """The network, trained for 48 steps on the chair's ten control points, or on `count` spread over it."""
    shape = chair()
    p = shape.p if count == 10 else nm.farthest_points(shape.vertices, shape.triangles, count)
    return nm.NeuralWeights.fit(p, bounds=shape.bounds, seed=SEED, width=width, steps=48)


@cache
def network(count: int = 10) -> Network:
    """The parameters of `weights(count)`."""
    with tempfile.TemporaryDirectory() as folder:
        arrays = stored(weights(count), Path(folder) / "network.weights")
    return Network(
        arrays["centre"], arrays["half"].item(), [(arrays[f"weight{i}"], arrays[f"bias{i}"]) for i in range(3)]
    )


def stored(what: nm.NeuralWeights, path: Path) -> dict[str, NDArray[np.generic]]:
    """What `save` writes."""
    what.save(path)
    return dict(load_file(path))


def fresh() -> nm.NeuralWeights:
    """The same network, never evaluated: nothing that an evaluation prepares once is there yet."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "network.weights"
        weights().save(path)
        return nm.NeuralWeights.load(path)


def dense() -> nm.NeuralWeights:
    """The same function on our own dense path: Fourier features, which are not piecewise linear, with weights of 0."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "network.weights"
        arrays = stored(weights(), path)
        arrays["frequencies"] = np.ones((1, 3), np.float32)
        arrays["weight0"] = np.concatenate(
            [arrays["weight0"], np.zeros((len(arrays["weight0"]), 2), np.float32)], axis=1
        )
        with safe_open(path, "numpy") as file:
            metadata = file.metadata()
        save_file(arrays, path, metadata=metadata)
        return nm.NeuralWeights.load(path)
