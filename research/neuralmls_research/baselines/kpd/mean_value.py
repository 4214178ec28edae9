"""Mean value coordinates of points in a closed triangle mesh (Ju, Schaefer, Warren 2005), in double precision.

What differs from the paper are the published code's thresholds, which KeypointDeformer was trained with. That code
computes in single precision, and is off by up to 1e-3 where a point sees a face of the cage almost edge-on: the face's
dihedral cosine rounds to 1.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

AT_VERTEX = 1e-8  # a point closer to a vertex than this is the vertex
ON_FACE = 1e-4  # radians that the angles of a face, seen from a point on it, may lack of pi
SIDEWAYS = 1e-5  # a face whose plane the point is in, by the sine of its dihedral angles
BLOCK = 1024  # points at a time: the tables of points and faces fit into the caches


def mean_value_coordinates(x: Array, cage: Array, faces: NDArray[np.int64]) -> Array:
    """Return `w` (n, k) with `w cage = x` and rows that sum to 1; they may be negative outside of a convex cage.

    `w_i = sum over faces of (theta_i - c_(i+1) theta_(i-1) - c_(i-1) theta_(i+1)) / (d_i sin theta_(i+1) s_(i-1))`,
    with the angles theta, lengths `d` and dihedral cosines `c` and sines `s` of the triangle that a face is on the
    sphere around the point.

    Parameters
    ----------
    x : (n, 3) float64
    cage : (k, 3) float64
    faces : (f, 3) int, in one orientation
    """
    onto = np.zeros((faces.size, len(cage)))  # sums over the faces of each vertex, as one product
    onto[np.arange(faces.size), faces.ravel()] = 1
    w = np.empty((len(x), len(cage)))
    for start in range(0, len(x), BLOCK):
        w[start : start + BLOCK] = _block(x[start : start + BLOCK], cage, faces, onto)
    return w


def _block(x: Array, cage: Array, faces: NDArray[np.int64], onto: Array) -> Array:
    away = cage - x[:, None]
    d = np.linalg.norm(away, axis=2)
    at_vertex = d < AT_VERTEX
    u = (away / np.where(at_vertex, 1.0, d)[:, :, None])[:, faces]  # (n, f, corner, 3)
    after, before = [1, 2, 0], [2, 0, 1]
    theta = 2 * np.arcsin(np.minimum(np.linalg.norm(u[:, :, after] - u[:, :, before], axis=3) / 2, 1.0))
    h = theta.sum(axis=2) / 2
    sine = np.sin(theta)
    d = d[:, faces]
    with np.errstate(divide="ignore", invalid="ignore"):
        c = 2 * np.sin(h)[:, :, None] * np.sin(h[:, :, None] - theta) / (sine[:, :, after] * sine[:, :, before]) - 1
        c = np.where(np.abs(c) >= 1, np.sign(c) * (1 - 1e-5), c)
        det = np.einsum("nfi,nfi->nf", u[:, :, 0], np.cross(u[:, :, 1], u[:, :, 2]))
        s = np.sign(det)[:, :, None] * np.sqrt(1 - c * c)
        part = theta - c[:, :, after] * theta[:, :, before] - c[:, :, before] * theta[:, :, after]
        part /= d * sine[:, :, after] * s[:, :, before]
    sound = np.isfinite(part).all(axis=2) & (np.abs(s) > SIDEWAYS).all(axis=2)
    part[~sound] = 0.0
    lack = np.pi - h
    on_face = np.flatnonzero((lack < ON_FACE).any(axis=1))
    face = lack[on_face].argmin(axis=1)
    part[on_face] = 0.0
    part[on_face, face] = (sine * d[:, :, after] * d[:, :, before])[on_face, face]
    w: Array = part.reshape(len(x), -1) @ onto
    w = np.where(at_vertex.any(axis=1)[:, None], at_vertex, w)
    w /= w.sum(axis=1, keepdims=True)
    return w
