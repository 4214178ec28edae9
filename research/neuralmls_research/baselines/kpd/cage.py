"""The cage: a sphere of 80 triangles around the shape, drawn towards it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from neuralmls_research.baselines.checks import library

Array = NDArray[np.float64]

RADIUS = 1.4
STEPS = 100
STEP = 0.01
NEAR = 0.4

# The icosahedron as the published code has it: its coordinates have four digits.
_A, _B = 0.5257, 0.8507
_FACES = (
    "0 11 5  0 5 1  0 1 7  0 7 10  0 10 11  1 5 9  5 11 4  11 10 2  10 7 6  7 1 8  "
    "3 9 4  3 4 2  3 2 6  3 6 8  3 8 9  4 9 5  2 4 11  6 2 10  8 6 7  9 8 1"
)


def icosphere() -> tuple[Array, NDArray[np.int64]]:
    """Return the vertices (42, 3) and faces (80, 3) of an icosahedron subdivided once, on the sphere of radius 1.4.

    The middles of the edges come after the icosahedron's vertices, in the order of the sorted edges.
    """
    first = np.array([(-_A, _B, 0), (_A, _B, 0), (-_A, -_B, 0), (_A, -_B, 0)])
    corners = np.concatenate([np.roll(first, turn, axis=1) for turn in range(3)])
    faces = np.array(_FACES.split(), dtype=np.int64).reshape(-1, 3)
    sides = np.sort(faces[:, [[1, 2], [2, 0], [0, 1]]], axis=2)  # of each face, the side opposite each corner
    edges, which = np.unique(sides.reshape(-1, 2), axis=0, return_inverse=True)
    middle = which.reshape(-1, 3) + len(corners)
    v = np.concatenate([corners, corners[edges].mean(axis=1)])
    v *= RADIUS / np.linalg.norm(v, axis=1, keepdims=True)
    rows = [np.stack([faces[:, i], middle[:, (i + 2) % 3], middle[:, (i + 1) % 3]], axis=1) for i in range(3)]
    return v, np.concatenate([*rows, middle])


def draw_in(cage: Array, x: Array) -> Array:
    """Return the cage (k, 3) after 100 times: vertices farther than 0.4 from any of `x` (n, 3) shrink by 1 %."""
    tree = library("scipy.spatial").cKDTree(x)
    drawn = cage.copy()
    for _ in range(STEPS):
        distance, _ = tree.query(drawn)
        drawn[distance > NEAR] *= 1 - STEP
    return drawn
