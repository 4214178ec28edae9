"""The logits of shape-aware weights in NumPy, without a network, with settings to choose (crates/core: shape_graph)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from surface_graph import SurfaceGraph

Array = NDArray[np.float64]

POWER = 2.5
KEPT = 8.0  # logits below the largest by at most this are kept
TAIL = 4.0  # lower ones fall as this times a logarithm: weights as a power, which a network can learn
EXPONENT = 6.0  # of the straight-line distance, where no control point governs
REACH = 0.75  # of the spacing of the control points: how far along the shape one governs it
LEAST = 1e-6  # a distance, in halves of the shape's longest side: what is nearer is on the control point
LEAST_SHARE = 1e-12  # of walks: fewer are rounding


NEAR, NEAR_END, OWN = 0.55, 0.75, 0.8  # of the way to the second nearest; the least weight there


def shape_logits(
    graph: SurfaceGraph,
    p: Array,
    *,
    distances: Array | None = None,
    power: float = POWER,
    kept: float = KEPT,
    reach: float = REACH,
) -> Array:
    """Return the logits of the control points (m, d) at every node of a shape, (nodes, m); the largest is 0.

    With distances along the shape, (nodes, m), what is near to a control point by them follows it.
    """
    along = graph.reach(p)
    met = np.log(np.maximum(graph.first_met(p, along), LEAST_SHARE))
    straight = np.log(np.maximum(np.linalg.norm(graph.nodes[:, None] - p, axis=2), LEAST))
    share = np.minimum(1, reach * np.median(along.apart) / np.maximum(along.far, LEAST))[:, None] ** 4
    logits = share * power * met - (1 - share) * EXPONENT * straight
    if distances is not None:
        logits = _followed(logits, distances)
    below = logits.max(axis=1, keepdims=True) - logits
    return np.asarray(-np.minimum(below, kept) - TAIL * np.log1p(np.maximum(below - kept, 0) / TAIL))


def _followed(logits: Array, distances: Array) -> Array:
    """Return the logits (nodes, m), raised where a control point is near and has less than `OWN` of the weight."""
    rows, own = np.arange(len(logits)), distances.argmin(axis=1)
    first, second = np.sort(distances, axis=1)[:, :2].T
    least = OWN * np.clip((NEAR_END - first / second) / (NEAR_END - NEAR), 0, 1)
    others = logits.copy()
    others[rows, own] = -np.inf
    most = others.max(axis=1)
    sums = np.exp(others - most[:, None]).sum(axis=1)
    raised = logits.copy()
    with np.errstate(divide="ignore"):
        raised[rows, own] = np.maximum(logits[rows, own], most + np.log(sums * least / (1 - least)))
    return raised
