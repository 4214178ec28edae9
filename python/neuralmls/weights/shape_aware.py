"""Weights that know the shape: a network taught by distances along it, besides the control points."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from neuralmls import _core
from neuralmls.arrays import Progress, as_box, as_count, as_points, box_around
from neuralmls.weights.network import NetworkWeights
from neuralmls.weights.surface_graph import SurfaceGraph

Array = NDArray[np.float64]

# Chosen once, for all shapes, by studies/shape_aware.py.
EXPONENT = 6.0
ALONG = 1.0  # of the exponent that belongs to the distance along the shape; the rest to the straight-line distance
REACH = 0.75  # of the spacing of the control points: as far along the shape as a control point governs it
SAMPLES = 1024
BATCH = 128
WIDTH = 512
STEPS = 400
RATE = 2e-3


class ShapeAwareWeights(NetworkWeights):
    """A network whose logits follow the shape: parts near in space but far along the shape move apart."""

    @classmethod
    def fit(
        cls,
        control_points: ArrayLike,
        x: ArrayLike,
        faces: ArrayLike | None = None,
        *,
        bounds: ArrayLike | None = None,
        seed: int = 0,
        progress: Progress | None = None,
    ) -> ShapeAwareWeights:
        """Train a network to give the weights `1 / (D_i^a E_i^(1 - a))^6` on the shape.

        `E_i` is the straight-line distance from control point i and `D_i` that along the shape: the shortest path over its
        triangles, between parts that touch or overlap, and where none does, between their nearest points.
        """
        p = as_points("control_points", control_points)
        points = as_points("x", x, p.shape[1])
        as_count("seed", seed, 0, 2**64 - 1)
        centre, half = box_around(points) if bounds is None else as_box(bounds, p.shape[1])
        origin = np.array(centre)
        samples, labels = taught(
            (p - origin) / half, (points - origin) / half, None if faces is None else np.asarray(faces)
        )
        network, losses, loss = _core.fit(
            p, centre, half, WIDTH, STEPS, RATE, seed, None, progress, (samples * half + origin, labels, BATCH)
        )
        return cls(p, network, losses, loss)


def taught(p: Array, x: Array, faces: NDArray[Any] | None) -> tuple[Array, NDArray[np.float32]]:
    """Return samples of the shape (k, d) and how likely each control point is to be there, (k, m)."""
    graph = SurfaceGraph(x, faces)
    along = graph.distances(p)
    chosen = graph.spread(SAMPLES)
    return graph.nodes[chosen], labels(p, graph.nodes[chosen], along[:, chosen].T, spacing(p, along, graph))


def spacing(p: Array, along: Array, graph: SurfaceGraph) -> float:
    """Return how far a control point is from its nearest along the shape: the median."""
    if len(p) == 1:
        return np.inf
    apart = along[:, graph.nearest(p)]
    np.fill_diagonal(apart, np.inf)
    return float(np.median(apart.min(axis=1)))


def labels(p: Array, x: Array, along: Array, spacing: float) -> NDArray[np.float32]:
    """Return the probabilities of the control points (m, d) at points (k, d) that distances along the shape (k, m) give."""
    straight = np.maximum(np.linalg.norm(x[:, None] - p, axis=2), 1e-6)
    along = np.maximum(along, straight)
    share = ALONG * np.minimum(1, REACH * spacing / along.min(axis=1, keepdims=True)) ** 4
    logits = -EXPONENT * (share * np.log(along) + (1 - share) * np.log(straight))
    weights = np.exp(logits - logits.max(axis=1, keepdims=True))
    return np.asarray(weights / weights.sum(axis=1, keepdims=True), dtype=np.float32)
