"""What is near a control point along the shape follows it: `python studies/shape_aware_law.py DATA [NAME...]`.

On every manufactured shape of the data with up to 30,000 vertices: places that are nearer to one of 12 or 40 control
points, along the shape, than half of the way to any other, and how many of them it has less than half of the weight at:
by walks alone, by the labels that the network is taught, and by the network. And at which part of all places the
network gives less than half of the weight that one was to have (of which the report tells, if it is much).
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from shape_logits import shape_logits
from surface_graph import SurfaceGraph

import neuralmls as nm

MOST = 30_000
COUNTS = (12, 40)


def shapes(data: Path, names: list[str], count: int) -> Iterator[tuple[str, nm.Shape, NDArray[np.float64]]]:
    """The case that broke, with its own 12 control points, and all others with as many as are told, spread evenly."""
    case = data / "cases" / "shape-aware-legs"
    if count == 12:
        yield "shape-aware-legs", nm.read(case / "model.obj"), nm.Session.read(case / "points.json").points.sources
    files = [*data.glob("shapenet/*/*.obj"), *data.glob("manufactured/*/*.obj"), *data.glob("manufactured/*/*.gl*")]
    for path in sorted(files):
        name = f"{path.parent.name}/{path.name}"
        if names and not any(part in name for part in names):
            continue
        try:
            shape = nm.read(path)
        except nm.NeuralMLSError:
            continue
        if shape.faces is not None and len(shape.faces) and 20 < len(shape.positions) <= MOST:
            yield name, shape, nm.farthest_points(shape.positions, shape.faces, count)


def violations(shape: nm.Shape, p: NDArray[np.float64]) -> tuple[int, list[int], float]:
    """How many places the law is about, how many break it by walks, labels, and the network; the part not learned."""
    low, high = shape.bounds
    centre, half = (low + high) / 2, (high - low).max() / 2
    at = (p - centre) / half
    graph = SurfaceGraph((shape.positions - centre) / half, shape.faces)
    distances = graph.distances(at)
    first, second = np.sort(distances, axis=1)[:, :2].T
    law = np.flatnonzero(first < 0.5 * second)
    own = distances.argmin(axis=1)[law]
    walks, labels = shape_logits(graph, at), shape_logits(graph, at, distances=distances)
    network = nm.ShapeAwareWeights.fit(p, shape.positions, shape.faces).logits(graph.nodes * half + centre)
    broken = []
    for logits in (walks, labels, network):
        weights = nm.softmax(logits)[law, own]
        broken.append(int((weights < 0.5).sum()))
    rows, most = np.arange(len(labels)), labels.argmax(axis=1)
    taught, found = nm.softmax(labels)[rows, most], nm.softmax(network)[rows, most]
    return len(law), broken, float(((taught > 0.5) & (found < 0.5 * taught)).mean())


def main(data: Path, names: list[str]) -> None:
    """Print a line a shape."""
    for control_points in COUNTS:
        sums, worst = np.zeros(4, dtype=int), 0.0
        for name, shape, p in shapes(data, names, control_points):
            count, broken, missed = violations(shape, p)
            sums += [count, *broken]
            worst = max(worst, missed)
            said = f"by walks {broken[0]}, labels {broken[1]}, network {broken[2]}; {100 * missed:.2f} % not learned"
            print(f"{name}: {count} places; {said}", flush=True)
        said = f"by walks {sums[1]}, labels {sums[2]}, network {sums[3]}; at most {100 * worst:.2f} % not learned"
        print(f"{control_points} control points, in all: {sums[0]} places; {said}")


if __name__ == "__main__":
    main(Path(sys.argv[1]), sys.argv[2:])
