"""Whether a drag has jumps: `python -m studies.drags FOLDER`, a minute; FOLDER as in `studies.exact_handles`.

Control points of the paper's shapes, and 40 spread over each, are dragged in steps: far away, through their neighbours,
past each other, bent, mirrored, each on its own way. Where a drag moves the shape fastest, the step is halved again and
again; what is left then is a jump. Soft, with the best aim that is found (`ExactHandles.aim`), and with the careful one
(`ExactHandles.aim_carefully`), where control points own a quarter of their places. Prints a table of
docs/notes/beyond-the-paper.md.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import neuralmls as nm
from studies.exact_handles import cases

Array = NDArray[np.float64]
Way = Callable[[float], Array]

STEPS, HALVINGS, PLACES, SPREAD = 40, 22, 400, 40
TEMPERATURES = (1.0, 2.0, 3.0)
ARRIVED, JUMP = 1e-6, 1e-3
OWNED = 0.25


def ways(p: Array, rng: np.random.Generator) -> Iterator[Way]:
    """Where control points go, from 0 to 1."""
    side = float(np.ptp(p, axis=0).max())
    axis = int(np.ptp(p, axis=0).argmax())
    middle, across = p.mean(axis=0), (axis + 1) % 3
    far = p[:, axis] > np.median(p[:, axis])
    near = np.linalg.norm(p[:, None] - p, axis=2).argsort(axis=1)

    def straight(q: Array) -> Way:
        return lambda t: p + t * (q - p)

    def bent(t: float) -> Array:
        q, (sin, cos) = p.copy(), (np.sin(3 * t), np.cos(3 * t))
        along, up = (p[far][:, k] - middle[k] for k in (axis, across))
        q[far, axis], q[far, across] = middle[axis] + cos * along - sin * up, middle[across] + sin * along + cos * up
        return q

    yield bent
    for _ in range(2):
        i, direction = int(rng.integers(len(p))), rng.normal(size=3)
        pulled, through, sheared = p.copy(), p.copy(), p.copy()
        pulled[i] += side * direction / np.linalg.norm(direction)
        yield straight(pulled)
        through[i] += 3 * (p[near[i, 1:5]].mean(axis=0) - p[i])
        yield straight(through)
        apart = 0.5 * side * direction / np.linalg.norm(direction)
        sheared[i], sheared[near[i, 1]] = p[i] + apart, p[near[i, 1]] - apart
        yield straight(sheared)
    for mirrored in (slice(None), far):
        q = p.copy()
        q[mirrored, across] = 2 * middle[across] - q[mirrored, across]
        yield straight(q)


def dragged(way: Way, places: Callable[[Array], Array]) -> tuple[float, Array]:
    """The jump that is left where the drag moves the places fastest, and how far the control points stay away."""
    ts = np.linspace(0, 1, STEPS + 1)
    went = [places(way(t)) for t in ts]
    misses = np.array([np.linalg.norm(y[: len(q)] - q, axis=1).max() for y, q in zip(went, map(way, ts), strict=True)])
    worst = max(range(STEPS), key=lambda step: moved(went[step], went[step + 1]))
    before, after, low, high = went[worst], went[worst + 1], ts[worst], ts[worst + 1]
    for _ in range(HALVINGS):
        between = places(way((low + high) / 2))
        if moved(before, between) > moved(between, after):
            after, high = between, (low + high) / 2
        else:
            before, low = between, (low + high) / 2
    return moved(before, after), misses


def moved(before: Array, after: Array) -> float:
    """The longest way from one to the other."""
    return float(np.linalg.norm(after - before, axis=1).max())


def handles(bound: nm.Deformer, exact: nm.ExactHandles, temperature: float) -> dict[str, Callable[[Array], Array]]:
    """Where the points go, for targets: softly, with the best aim that is found, and carefully."""
    return {
        "soft": lambda q: np.asarray(bound.deform(q, temperature)),
        "best found": lambda q: np.asarray(bound.deform(exact.aim(q, temperature).targets, temperature)),
        "careful": lambda q: np.asarray(bound.deform(exact.aim_carefully(q, temperature).targets, temperature)),
    }


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    given = parser.parse_args()
    rng = np.random.default_rng(0)
    shapes = {case.p.tobytes(): case for case in cases(given.folder)}
    found: dict[tuple[str, float], list[tuple[float, Array]]] = {}
    for case in shapes.values():
        x = case.shape.positions
        for p in (case.p, nm.farthest_points(x, case.shape.faces, SPREAD)):
            weights = nm.NeuralWeights.fit(p, bounds=case.shape.bounds)
            handled = list(ways(p, rng))
            bound = nm.Deformer(np.concatenate([p, x[rng.integers(len(x), size=PLACES)]]), weights)
            exact = nm.ExactHandles(weights)
            for temperature in TEMPERATURES:
                if np.diagonal(nm.softmax(weights.logits(p), temperature)).min() < OWNED:
                    continue
                for aim, places in handles(bound, exact, temperature).items():
                    for way in handled:
                        jump, misses = dragged(way, places)
                        found.setdefault((aim, temperature), []).append((jump / case.side, misses / case.side))
    print("| handles | temperature | drags | with a jump | greatest, % | arrive | median miss of others, % |")
    print("|---|---|---|---|---|---|---|")
    for (aim, temperature), drags in found.items():
        jumps, misses = np.array([jump for jump, _ in drags]), np.concatenate([misses for _, misses in drags])
        rest = misses[misses > ARRIVED]
        print(
            f"| {aim} | {temperature:g} | {len(drags)} | {(jumps > JUMP).sum()} | {100 * jumps.max():.2g} "
            f"| {100 * (misses <= ARRIVED).mean():.1f} % | {100 * np.median(rest) if len(rest) else 0:.2g} |"
        )


if __name__ == "__main__":
    main()
