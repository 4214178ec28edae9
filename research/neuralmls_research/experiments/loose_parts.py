"""Methods that need a control point on each connected part, on shapes that have parts without: eyes, teeth, buttons.

A solver for surfaces cannot say where such a part goes, and refuses. Its user would let the part go with what it sits
on; so that it is not judged only where it has no such parts, this does.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from neuralmls.plugin import as_points
from neuralmls_research.baselines.checks import library
from neuralmls_research.baselines.rigid import moved_rigidly
from neuralmls_research.experiments.methods import Array, Bound, Geometry, Method, Surface

NEAREST = 8  # vertices, at least, that a part goes with


def with_loose_parts(method: Method) -> Method:
    """Return the method for all parts that have a control point, the others moved rigidly with what is nearest to them.

    The motion of a loose part is the rigid one that fits best what the vertices nearest to its own do. A shape
    without loose parts is deformed as by the method itself.
    """

    def bind(shape: Geometry, p: ArrayLike) -> Bound:
        parts = None if shape.faces is None else _parts(len(shape.positions), np.asarray(shape.faces))
        if parts is None:
            return method.bind(shape, p)
        x = shape.positions
        _, nearest = library("scipy.spatial").cKDTree(x).query(as_points("p", p, 3))
        held = np.isin(parts, parts[nearest])
        if held.all():
            return method.bind(shape, p)
        number = np.cumsum(held) - 1
        faces = np.asarray(shape.faces)
        bound = method.bind(Surface(x[held], number[faces[held[faces[:, 0]]]]), p)
        beside = {part: _beside(x[parts == part], x[held]) for part in np.unique(parts[~held])}

        def positions(q: ArrayLike) -> Array:
            y = x.copy()
            y[held] = bound.positions(q)
            for part, around in beside.items():
                y[parts == part] = moved_rigidly(x[parts == part], x[held][around], y[held][around])
            return y

        return Bound(positions)

    return replace(method, title=f"{method.title}, loose parts follow", bind=bind)


def _parts(count: int, faces: NDArray[np.int64]) -> NDArray[np.int64]:
    """The connected part of each vertex."""
    sides = faces[:, [0, 1, 1, 2]].reshape(-1, 2)
    graph = library("scipy.sparse").coo_matrix((np.ones(len(sides)), sides.T), shape=(count, count))
    parts: NDArray[np.int64] = library("scipy.sparse.csgraph").connected_components(graph, directed=False)[1]
    return parts


def _beside(part: Array, held: Array) -> NDArray[np.int64]:
    """The vertices, of those with a control point on their part, that are nearest to a part's."""
    tree = library("scipy.spatial").cKDTree(held)
    _, each = tree.query(part)
    _, around = tree.query(part.mean(axis=0), k=min(NEAREST, len(held)))
    return np.unique(np.concatenate([each, np.atleast_1d(around)]))
