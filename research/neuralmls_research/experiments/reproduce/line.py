"""The paper's line: six control points, their weights, and what can be said of a curve."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from neuralmls import InverseDistanceWeights, NeuralWeights, Weights, softmax
from neuralmls_research.experiments.reproduce.lab import Lab

Array = NDArray[np.float64]

X = np.linspace(-5.0, 5.0, 801)[:, None]
# The published script spreads six evenly over [-4, 4] and jitters them by 0.7, from a seed that it does not fix.
BEFORE = np.array([[-4.3], [-2.6], [-1.1], [1.3], [2.1], [4.2]])

AFTER = BEFORE - np.eye(6)[:, 3:4]
SETTING = (
    "801 points from -5 to 5, six control points; network of width {width} trained for 500 steps on the raw "
    "coordinates, temperature 1; classic weights 1/(d² + 10⁻⁶). The parameters are those of the published script, the "
    "control points are ours: it draws them without a fixed seed."
)


def functions(lab: Lab, p: Array) -> dict[str, Weights]:
    """Neural and classic weights of control points (m, 1)."""
    raw = [[-1.0], [1.0]]  # the published script does not normalise the line
    return {
        "neural": NeuralWeights.fit(p, bounds=raw, width=lab.width, steps=50 if lab.quick else 500),
        "classic": InverseDistanceWeights(p, alpha=1.0, epsilon=1e-6, bounds=raw),
    }


def weights_on_line(function: Weights) -> Array:
    """Its weights over the line, (n, m)."""
    return softmax(function.logits(X))


def peaks(curve: Array) -> int:
    """How many local maxima a curve (n,) has, ends included, waves of less than a hundredth of its range left out.

    Examples
    --------
    >>> peaks(np.array([0.0, 1.0, 0.2, 0.7, 0.1]))
    2
    """
    least = 0.01 * float(np.ptp(curve))
    count, rising, extreme = 0, True, float(curve[0])
    for value in curve[1:].tolist():
        if rising:
            if value > extreme:
                extreme = value
            elif value < extreme - least:
                count, rising, extreme = count + 1, False, value
        elif value < extreme:
            extreme = value
        elif value > extreme + least:
            rising, extreme = True, value
    return count + rising
