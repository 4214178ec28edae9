"""How many neurons cross zero inside a small box: what exact piecewise-linear evaluation has to compute at least.

A neuron that is surely on or surely off over a box is affine there and costs nothing a point. Interval bounds for the
first layer, for the second with the first's crossing neurons between two parallel lines. This counts; it evaluates
nothing.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from benchmarks.inputs import Network

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

LEAF = 64  # points
PATHS = 24  # from the root to a leaf, taken at random: the tree is balanced, so that each leaf is as likely


@dataclass(frozen=True)
class Work:
    """Mean crossing neurons of a leaf, and the operations for all points: in the leaves, and in all boxes above."""

    first: float
    second: float
    in_leaves: float
    in_boxes: float


def crossing(network: Network, centre: Array, half: Array) -> tuple[Mask, Mask]:
    """Which neurons of the first and of the second layer may be 0 somewhere in a box (already centred and scaled)."""
    (w0, b0), (w1, b1) = network.layers[:2]
    middle, radius = w0 @ centre + b0, np.abs(w0) @ half
    low, high = middle - radius, middle + radius
    on, first = low >= 0, (low < 0) & (high > 0)
    slope = np.where(on, 1.0, np.where(first, high / np.where(first, high - low, 1.0), 0.0))
    width = np.where(first, -slope * low / 2, 0.0)  # of the band between the two lines, to either side
    # One product: of the slopes' rows (for the affine map), of its constants, of the bands.
    columns = np.column_stack([slope[:, None] * w0, slope * middle + width])
    affine = w1 @ columns.astype(np.float32)
    reach = np.abs(affine[:, :3]) @ half + np.abs(w1[:, first]) @ width[first]
    value = affine[:, 3] + b1
    return first, np.abs(value) < reach


def work(network: Network, x: Array) -> Work:
    """Count along random paths down a kd-tree over the points `x`."""
    scaled = (x - network.centre) / network.half
    m = len(network.layers[2][1])
    rng = np.random.default_rng(0)
    leaves, boxes, firsts, seconds = [], [], [], []
    for _ in range(PATHS):
        points, above, total, share = scaled, (1024.0, 1024.0), 0.0, 1.0
        while True:
            low, high = points.min(axis=0), points.max(axis=0)
            first, second = crossing(network, (low + high) / 2, (high - low) / 2)
            c1, c2 = float(first.sum()), float(second.sum())
            # For each row open above: columns resolved here are folded into its affine map (4 numbers), crossing ones
            # give slope and band (5). Rows resolved here are folded into the output map.
            fused = above[1] * (4 * (above[0] - c1) + 5 * c1) + m * (above[1] - c2) * (c1 + 4)
            total += share * 2 * fused
            above = c1, c2
            if len(points) <= LEAF:
                break
            axis = int((high - low).argmax())
            order = np.argpartition(points[:, axis], len(points) // 2)
            points = points[order[: len(points) // 2] if rng.random() < 0.5 else order[len(points) // 2 :]]
            share *= 2
        firsts.append(c1)
        seconds.append(c2)
        leaves.append(2 * (3 * c1 + c2 * (c1 + 3) + m * (c1 + c2 + 3)) * len(x))
        boxes.append(total)
    return Work(*(float(np.mean(values)) for values in (firsts, seconds, leaves, boxes)))
