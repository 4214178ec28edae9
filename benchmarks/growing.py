"""The definition `growth` on the threads that this process was given: `python -m benchmarks.growing [--quick]`."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from statistics import median
from time import perf_counter

import numpy as np

import neuralmls as nm
from benchmarks import answers, inputs

POINTS = (1000, 10_000, 100_000, 1_000_000, 10_000_000)
CONTROL_POINTS = (4, 16, 64, 256)
FEW = 100_000  # points where the control points grow
PATIENCE = 1.0  # seconds that each figure may take, beyond its first


def grown(quick: bool) -> list[dict[str, float | int]]:
    """The figures of this process, with the threads that it was given."""
    sizes = [(n, 10) for n in POINTS[: 2 if quick else None]]
    sizes += [(1000 if quick else FEW, m) for m in CONTROL_POINTS[: 2 if quick else None]]
    return [line(n, m) for n, m in sizes]


def line(n: int, m: int) -> dict[str, float | int]:
    """All steps for n points and m control points."""
    shape = inputs.chair()
    x = inputs.surface(n)
    weights = inputs.weights(m)
    tree = inputs.tree(x)
    logits = weights.logits(tree)
    at = inputs.subset(500, n)
    error = float(np.abs(logits[at] - answers.logits(inputs.network(m), x[at])).max())
    deformer = nm.Deformer(x, inputs.Given(weights.control_points, logits))
    q = weights.control_points + [0.0, 0.1, 0.0] * (weights.control_points[:, 1:2] > 0.5)
    out = np.empty_like(x)
    return {
        "points": n,
        "control points": m,
        "training, 48 steps": timed(
            lambda: nm.NeuralWeights.fit(weights.control_points, bounds=shape.bounds, steps=48)
        ),
        "tree": timed(lambda: inputs.tree(x)),
        "logits": timed(lambda: weights.logits(tree)),
        "rigid frame": timed(lambda: deformer.deform(q, 1.0, out=out)),
        "error": error,
    }


def timed(work: Callable[[], object]) -> float:
    """The median seconds of several calls, of fewer where one takes long."""
    taken: list[float] = []
    while not taken or (len(taken) < 5 and sum(taken) < PATIENCE):
        start = perf_counter()
        work()
        taken.append(perf_counter() - start)
    return median(taken)


if __name__ == "__main__":
    print(json.dumps(grown("--quick" in sys.argv)))
