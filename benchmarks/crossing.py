"""How many neurons cross zero inside a small box: what exact piecewise-linear evaluation has to compute at least.

A neuron that is surely on or surely off over a box is affine there and costs nothing a point. Interval bounds for the
first layer, for the second with the first's crossing neurons between two parallel lines; where the evaluator looks at
each point of a box, bounds of the same at the points. This counts; it evaluates nothing.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from benchmarks.inputs import Network

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

LEAF = 64  # points
STEP = 3  # levels from a box to the next one that the evaluator makes
MANY = 64  # columns from which on it looks at points
PATHS = 24  # from the root to a leaf, taken at random: each point's is as likely


@dataclass(frozen=True)
class Work:
    """Mean crossing neurons of a leaf, and the operations for all points: in the leaves, and in all boxes above."""

    first: float
    second: float
    in_leaves: float
    in_boxes: float


def crossing(network: Network, centre: Array, half: Array, points: Array | None = None) -> tuple[Mask, Mask]:
    """Which neurons of the first and of the second layer may be 0 somewhere in a box (already centred and scaled).

    With `points`: somewhere between its points."""
    (w0, b0), (w1, b1) = network.layers[:2]
    middle, radius = w0 @ centre + b0, np.abs(w0) @ half
    low, high = middle - radius, middle + radius
    if points is not None:
        values = points @ w0.T + b0
        low, high = values.min(axis=0), values.max(axis=0)
    on, first = low >= 0, (low < 0) & (high > 0)
    slope = np.where(on, 1.0, np.where(first, high / np.where(first, high - low, 1.0), 0.0))
    width = np.where(first, -slope * low / 2, 0.0)  # of the band between the two lines, to either side
    # One product: of the slopes' rows (for the affine map), of its constants, of the bands.
    columns = np.column_stack([slope[:, None] * w0, slope * middle + width])
    affine = w1 @ columns.astype(np.float32)
    band = np.abs(w1[:, first]) @ width[first]
    value = affine[:, 3] + b1
    if points is not None and first.sum() >= MANY:
        values = (points - centre) @ affine[:, :3].T + value
        return first, (values.min(axis=0) < band) & (values.max(axis=0) > -band)
    return first, np.abs(value) < np.abs(affine[:, :3]) @ half + band


def work(network: Network, x: Array) -> Work:
    """Count along random paths down a kd-tree over the points `x`."""
    scaled = (x - network.centre) / network.half
    m = len(network.layers[2][1])
    rng = np.random.default_rng(0)
    leaves, boxes, firsts, seconds = [], [], [], []
    for _ in range(PATHS):
        points, total, boxes_above = scaled, 0.0, [(1024.0, 1024.0)]
        while True:
            low, high = points.min(axis=0), points.max(axis=0)
            made_from = boxes_above[-STEP:][0]
            look = made_from[0] >= MANY and (len(points) <= LEAF or len(points) <= made_from[1] / 2)
            first, second = crossing(network, (low + high) / 2, (high - low) / 2, points if look else None)
            c1, c2 = float(first.sum()), float(second.sum())
            above = boxes_above[-1]
            # For each row open above: columns resolved here are folded into its affine map (4 numbers), crossing ones
            # give slope and band (5). Rows resolved here are folded into the output map.
            fused = above[1] * (4 * (above[0] - c1) + 5 * c1) + m * (above[1] - c2) * (c1 + 4)
            total += len(x) / len(points) * 2 * fused
            boxes_above.append((c1, c2))
            if len(points) <= LEAF:
                break
            # Each half has whole leaves.
            left = LEAF * -(-len(points) // (2 * LEAF))
            order = np.argpartition(points[:, int((high - low).argmax())], left - 1)
            points = points[order[:left] if rng.random() < left / len(points) else order[left:]]
        firsts.append(c1)
        seconds.append(c2)
        leaves.append(2 * (3 * c1 + c2 * (c1 + 3) + m * (c1 + c2 + 3)) * len(x))
        boxes.append(total)
    return Work(*(float(np.mean(values)) for values in (firsts, seconds, leaves, boxes)))
