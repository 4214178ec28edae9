"""The paper's line: six control points, their weights, and what can be said of a curve."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from neuralmls import InverseDistanceWeights, NeuralWeights, Weights, softmax
from neuralmls_research.experiments.reproduce.lab import Lab

Array = NDArray[np.float64]

X = np.linspace(-5.0, 5.0, 801)[:, None]
STEP = 0.0125
# The published script spreads six evenly over [-4, 4] and jitters them by 0.7, from a seed that it does not fix.
BEFORE = np.array([[-4.3], [-2.6], [-1.1], [1.3], [2.1], [4.2]])
MOVED = 3
AFTER = BEFORE - np.eye(6)[:, MOVED : MOVED + 1]
TEMPERATURES = (0.2, 1.0, 5.0)
# The published script's exponent is 1, but on the line it is one of d, in space one of d^2: here 1/(d + epsilon).
ALPHA, EPSILON = 0.5, 1e-6
_RAW = [[-1.0], [1.0]]  # the published script does not normalise the line
SETTING = (
    "801 points from -5 to 5, six control points; networks of width {width} trained for 500 steps on the raw "
    "coordinates, {seeds} seeds; classic weights 1/(d + 10⁻⁶): on the line the published script takes d itself to the "
    "power of its alpha of 1, in space d² (there 1/d is alpha 0.5). The parameters are those of the published script, "
    "the control points are ours: it draws them without a fixed seed."
)


def networks(lab: Lab, p: Array) -> list[NeuralWeights]:
    """Neural weights of control points (m, 1), one function a seed."""
    steps = 50 if lab.quick else 500
    return [NeuralWeights.fit(p, bounds=_RAW, width=lab.width, steps=steps, seed=seed) for seed in lab.seeds]


def classic(p: Array, alpha: float = ALPHA) -> InverseDistanceWeights:
    """Classic weights of control points (m, 1)."""
    return InverseDistanceWeights(p, alpha=alpha, epsilon=EPSILON, bounds=_RAW)


def weights_on_line(function: Weights, temperature: float = 1.0) -> Array:
    """Its weights over the line, (n, m), rows summing to 1."""
    return np.asarray(softmax(function.logits(X) / temperature), dtype=np.float64)


def raw_on_line(function: InverseDistanceWeights) -> Array:
    """Classic weights over the line as their formula gives them, 1/(d^(2 alpha) + epsilon): not normalised, (n, m)."""
    return np.exp(function.logits(X).astype(np.float64))


def slopes(curves: Array) -> Array:
    """Derivatives along the line of curves (n, k), (n, k)."""
    found: Array = np.gradient(curves, X[:, 0], axis=0)
    return found


def ruled(w: Array) -> float:
    """The share of the line where one control point has over 0.9 of the weight (n, m)."""
    return float((w.max(axis=1) > 0.9).mean())


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
