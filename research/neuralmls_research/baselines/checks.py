"""What the baselines share: their arguments, the nearest vertices, and what must hold before a native library runs."""

from __future__ import annotations

from importlib import import_module
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from neuralmls import Shape
from neuralmls.errors import ArgumentError, NeuralMLSError, NotApplicable
from neuralmls.plugin import RESEARCH, as_points, box_around

Array = NDArray[np.float64]

# A triangle is degenerate if twice its area is less than this of its longest side squared: its cotangents are noise.
FLAT = 1e-10


def library(module: str, needed_by: str = "this baseline") -> Any:
    """Import a library that the package brings.

    Raises
    ------
    NeuralMLSError
        It is not installed.
    """
    try:
        return import_module(module)
    except ImportError as error:
        raise NeuralMLSError(f"{needed_by} needs {module.split('.')[0]}, which is not installed: {RESEARCH}") from error


def arguments(method: str, shape: Shape, p: ArrayLike, q: ArrayLike) -> tuple[Array, Array, Array]:
    """Return the shape's positions, the control points and their targets: (n, 3), (m, 3), (m, 3).

    Raises
    ------
    ArgumentError
        The control points are no finite points in space, or not as many as targets.
    NotApplicable
        The shape has no vertices, or is not in space.
    """
    x = shape.positions
    if len(x) == 0 or x.shape[1] != 3:
        raise NotApplicable(f"{method} needs points in space, and the shape has {len(x)} with {x.shape[1]} coordinates")
    sources, targets = as_points("p", p, 3), as_points("q", q, 3)
    if len(sources) == 0 or len(targets) != len(sources):
        raise ArgumentError(
            f"q: expected one target for each of at least one control point, found {len(targets)} for {len(sources)}"
        )
    return x, sources, targets


def unit_of(x: Array) -> tuple[Array, float]:
    """Centre and half of the longest side of the box of points: what keeps their digits far from the origin."""
    low, high = box_around(x)
    centre, half = low + (high - low) / 2, float((high - low).max()) / 2 or 1.0
    return np.array(centre), half


def finite(method: str, y: Array) -> Array:
    """Return a result if all of it is finite.

    Raises
    ------
    NotApplicable
        It is not.
    """
    if not np.isfinite(y).all():
        raise NotApplicable(f"{method} gave positions that are not finite: the shape is too badly conditioned for it")
    return y


def nearest_vertices(method: str, x: Array, p: Array) -> NDArray[np.int64]:
    """Return for each control point the index of the vertex nearest to it, (m,).

    Raises
    ------
    NotApplicable
        Two control points have the same, so that it would have to be in two places.
    """
    _, nearest = library("scipy.spatial").cKDTree(x).query(p)
    indices = np.asarray(nearest, dtype=np.int64)
    _, first, counts = np.unique(indices, return_index=True, return_counts=True)
    if (counts > 1).any():
        vertex = indices[first[counts > 1][0]]
        a, b = np.flatnonzero(indices == vertex)[:2]
        raise NotApplicable(
            f"{method} moves vertices, and vertex {vertex} is nearest to both control points {a} and {b}"
        )
    return indices


def clean_mesh(method: str, shape: Shape, held: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return the faces, (f, 3), of a mesh that a solver for surfaces can take.

    Each vertex is on a face, each face has area, each edge is on one or two faces, the faces around each vertex are
    connected, and each connected part has one of the vertices `held`.

    Raises
    ------
    NotApplicable
        One of these does not hold; the sentence says which, and where.
    """
    x = shape.positions
    if shape.faces is None or len(shape.faces) == 0:
        raise NotApplicable(f"{method} needs a surface, and the shape is a cloud of points")
    faces = np.ascontiguousarray(shape.faces, dtype=np.int64)
    _check_used(method, len(x), faces)
    _check_area(method, x, faces)
    _check_manifold(method, faces)
    _check_held(method, len(x), faces, held)
    return faces


def _check_used(method: str, count: int, faces: NDArray[np.int64]) -> None:
    uses = np.bincount(faces.ravel(), minlength=count)
    if (uses == 0).any():
        unused = np.flatnonzero(uses == 0)
        raise NotApplicable(f"{method} needs every vertex on a face, and {len(unused)} are on none, first {unused[0]}")


def _check_area(method: str, x: Array, faces: NDArray[np.int64]) -> None:
    corners = x[faces]
    sides = corners[:, [1, 2, 0]] - corners
    longest = np.linalg.norm(sides, axis=2).max(axis=1)
    unit = np.where(longest > 0, longest, 1.0)[:, None, None]
    cross = np.cross(sides[:, 0] / unit[:, 0], sides[:, 1] / unit[:, 0])
    flat = np.flatnonzero((longest == 0) | (np.linalg.norm(cross, axis=1) < FLAT))
    if flat.size:
        raise NotApplicable(f"{method} needs triangles with area, and {flat.size} have none, first {flat[0]}")


def _check_manifold(method: str, faces: NDArray[np.int64]) -> None:
    sides = np.sort(faces[:, [[1, 2], [2, 0], [0, 1]]].reshape(-1, 2), axis=1)
    edges, counts = np.unique(sides, axis=0, return_counts=True)
    crowded = np.flatnonzero(counts > 2)
    if crowded.size:
        a, b = edges[crowded[0]]
        raise NotApplicable(
            f"{method} needs a manifold surface, and {crowded.size} edges are on more than two faces, "
            f"first the one from vertex {a} to {b} on {counts[crowded[0]]}"
        )
    pinched = np.flatnonzero(~library("igl").is_vertex_manifold(faces))
    if pinched.size:
        raise NotApplicable(
            f"{method} needs a manifold surface, and at {pinched.size} vertices parts meet that share no edge, "
            f"first {pinched[0]}"
        )


def _check_held(method: str, count: int, faces: NDArray[np.int64], held: NDArray[np.int64]) -> None:
    sides = faces[:, [[0, 1], [1, 2]]].reshape(-1, 2)
    graph = library("scipy.sparse").coo_matrix((np.ones(len(sides)), sides.T), shape=(count, count))
    parts, part = library("scipy.sparse.csgraph").connected_components(graph, directed=False)
    free = np.setdiff1d(np.arange(parts), part[held])
    if free.size:
        raise NotApplicable(
            f"{method} needs a control point on each connected part, and {free.size} of {parts} have none, "
            f"first that of vertex {np.flatnonzero(part == free[0])[0]}"
        )
