"""The picture of docs/placement.md: `python studies/placement_pictures.py PICTURE.png [SHAPE ...]`.

Shapes side by side, four in a row, each with 12 placed control points, in pairs where it is symmetric: the samples and
four creatures made by code, or the files that are named.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from creatures import Array, Indices, creature

import neuralmls as nm
from neuralmls.errors import ArgumentError
from neuralmls.figures.render import Panel, render
from neuralmls.samples import NAMES, make

COUNT = 12
ROW = 4
APART = 1.25  # in longest sides
CREATURES = (("four-legged", 2), ("two-legged", 2), ("hand", 1), ("octopus", 1))


def shapes(paths: list[str]) -> list[tuple[str, Array, Indices]]:
    """Name, positions with y upwards, triangles."""
    if paths:
        read = [(path, nm.read(path)) for path in paths]
        return [(path, shape.positions, np.asarray(shape.faces, dtype=np.int64)) for path, shape in read]
    samples = [(name, make(name).vertices, make(name).triangles) for name in NAMES]
    rests = [(kind, creature(kind, seed, poses=1).rest) for kind, seed in CREATURES]
    return samples + [(kind, rest.positions[:, [1, 2, 0]], np.asarray(rest.faces)) for kind, rest in rests]


def main(picture: Path, paths: list[str]) -> None:
    """Place and draw."""
    everything, triangles, points, count = [], [], [], 0
    for number, (name, x, faces) in enumerate(shapes(paths)):
        try:
            placed = nm.place(x, faces, COUNT, symmetric=True)
        except ArgumentError:  # not symmetric
            placed = nm.place(x, faces, COUNT)
        print(name, "" if placed.plane is None else f"in pairs across {placed.plane.normal.round(3)}")
        down, across = divmod(number, ROW)
        low, high = x.min(axis=0), x.max(axis=0)
        scale, shift = 1 / (high - low).max(), APART * np.array([across, -down, 0.0])
        everything.append((x - (low + high) / 2) * scale + shift)
        points.append((placed.points.sources - (low + high) / 2) * scale + shift)
        triangles.append(faces + count)
        count += len(x)
    panel = Panel("", np.concatenate(everything), np.concatenate(triangles))
    held = nm.ControlPoints(np.concatenate(points))
    render([panel], picture, control_points=held, width=1400, azimuth=25, elevation=20)


if __name__ == "__main__":
    main(Path(sys.argv[1]), sys.argv[2:])
