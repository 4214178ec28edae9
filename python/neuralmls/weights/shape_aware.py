"""Weights that know the shape: a network taught by random walks over it, besides the control points."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from neuralmls import _core
from neuralmls.arrays import Progress, as_box, as_count, as_points, box_around
from neuralmls.errors import ArgumentError
from neuralmls.weights.function import NetworkWeights, as_control_points
from neuralmls.weights.softmax import softmax
from neuralmls.weights.surface_graph import SurfaceGraph

Array = NDArray[np.float64]

# Chosen once, for all shapes, by studies/shape_aware.py; docs/notes/shape-aware.md has the figures.
POWER = 2.5
KEPT = 8.0  # logits below the largest by at most this are kept
TAIL = 4.0  # lower ones fall as this times a logarithm: weights as a power, which a network can learn
EXPONENT = 6.0  # of the straight-line distance, where no control point governs
REACH = 0.75  # of the spacing of the control points: how far along the shape one governs it
SOFTNESS = 2.0  # the network learns the weights to the power 1/2: what it gives is then sharpened as much
SAMPLES = 2048
BATCH = 128  # of them a step
WIDTH = 256
STEPS = 1000
RATE = 8e-3
LEAST = 1e-6  # a distance, in halves of the shape's longest side: what is nearer is on the control point
LEAST_SHARE = 1e-12  # of walks: fewer are rounding


class ShapeAwareWeights(NetworkWeights):
    """A network whose logits follow the shape: parts near in space but far along the shape move apart."""

    _kind = "shape-aware"

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
        """Train a network to give the weights `w_i ~ h_i^(2.5 s) / E_i^(6 (1 - s))` on a shape.

        `h_i` is the probability that a random walk over the shape meets control point i, or what it holds around it,
        before the others: over its triangles, across parts that touch or overlap, and from a part that touches none to
        its nearest. `E_i` is the straight-line distance. `s` is 1 where a control point governs the shape, less than
        3/4 of the control points' spacing away, measured along the shape; beyond, at a distance D, where the shape says
        less and less, `s = (3/4 spacing / D)^4`, and the nearest in space decide. Weights below e^-8 of the largest
        fall as a power of what they would be: a walk that passes control points is too seldom for a network to learn
        how seldom.

        Between the samples of the surface, and off it, the weights are what the network makes of them, as smooth as the
        paper's. The targets are not needed: one fit serves every drag.

        Parameters
        ----------
        control_points : (m, d), 1 to 1,000 of them, d = 2 or 3
        x : (n, d)
            The shape's points, at least one.
        faces : (f, 3) integers, optional
            Its triangles: any, of any quality, connected or not. Points without a triangle are linked to their nearest.
        bounds : (2, d), optional
            The shape's box, by which coordinates are normalised; that of `x` if not given.
        seed : int, 0 to 2^64 - 1
            The same seed gives the same bytes, whatever the number of threads.
        progress : callable, optional
            Told the fraction done, from 0 to 1; what it raises stops the training.

        Raises
        ------
        ArgumentError
            The points are not finite points or none; two control points are in one place; a face names no point.
        NeuralMLSError
            SciPy is not installed.

        Source
        ------
        The paper's network (Shechter et al. 2022, section 3), taught more: softened labels as in Hinton, Vinyals, Dean,
        "Distilling the knowledge in a neural network", 2015. Harmonic weights: Joshi et al., "Harmonic coordinates for
        character articulation", 2007, there in a cage; distances by Dijkstra's algorithm (SciPy).

        Examples
        --------
        Two legs side by side: the tip of one is near the control point of the other, but belongs to its own.

        >>> legs = np.array([[0.0, 0], [0, 1], [0.1, 1], [0.1, 0]])
        >>> lines = [[0, 1, 1], [1, 2, 2], [2, 3, 3]]
        >>> p = [[0, 0.1], [0.1, 0.9]]
        >>> ShapeAwareWeights.fit(p, legs, lines).logits([[0.1, 0.3]]).argmax()
        np.int64(1)
        """
        p = as_control_points(control_points)
        points = as_points("x", x, p.shape[1])
        if not len(points):
            raise ArgumentError("x: expected at least one point, found none")
        as_count("seed", seed, 0, 2**64 - 1)
        box = as_box(box_around(points) if bounds is None else bounds, p.shape[1])
        half = float((box[1] - box[0]).max()) / 2
        origin = box[0] + (box[1] - box[0]) / 2
        triangles = None if faces is None else np.asarray(faces)
        samples, labels = lessons((p - origin) / half, (points - origin) / half, triangles)
        core = _core.Weights.shape_aware(
            p, box, samples * half + origin, labels, BATCH, SOFTNESS, WIDTH, STEPS, RATE, seed, progress
        )
        return cls._of(core)


def lessons(p: Array, x: Array, faces: NDArray[Any] | None) -> tuple[Array, NDArray[np.float32]]:
    """Return what the network is taught: samples of the shape (k, d), and the softened weights there (k, m)."""
    graph = SurfaceGraph(x, faces)
    chosen = graph.spread(SAMPLES)
    logits = shape_logits(graph, p)[chosen]
    return graph.nodes[chosen], softmax(logits / SOFTNESS).astype(np.float32)


def shape_logits(
    graph: SurfaceGraph, p: Array, *, power: float = POWER, kept: float = KEPT, reach: float = REACH
) -> Array:
    """Return the logits of the control points (m, d) at every node of a shape, (nodes, m); the largest is 0."""
    along = graph.reach(p)
    met = np.log(np.maximum(graph.first_met(p, along), LEAST_SHARE))
    straight = np.log(np.maximum(np.linalg.norm(graph.nodes[:, None] - p, axis=2), LEAST))
    share = np.minimum(1, reach * np.median(along.apart) / np.maximum(along.far, LEAST))[:, None] ** 4
    logits = share * power * met - (1 - share) * EXPONENT * straight
    below = logits.max(axis=1, keepdims=True) - logits
    return np.asarray(-np.minimum(below, kept) - TAIL * np.log1p(np.maximum(below - kept, 0) / TAIL))
