"""Distances along a shape, whatever it is made of: a graph over its surface, and the shortest paths in it.

Vertices in one place are one node, and long edges are halved until paths over coarse triangles are about straight.
Within a connected part a path follows the triangles, so that two near legs stay far apart. Parts that touch or overlap
are joined by short links, and what is left by its nearest pair of nodes: every place can be reached from every other.
Points of a cloud, and vertices without a face, are linked to their nearest neighbours.
"""

from __future__ import annotations

from importlib import import_module
from typing import Any

import numpy as np
from numpy.typing import NDArray

from neuralmls.arrays import as_triangles
from neuralmls.errors import NeuralMLSError
from neuralmls.placement import farthest_of

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

SPACING = 0.06  # longest edge, in halves of the shape's longest side
TOUCH = 0.5 * SPACING  # parts nearer than this touch
MOST = 40_000  # nodes: long edges are no longer halved beyond
NEIGHBOURS = 8  # of a point of a cloud
MOST_SPREAD = 8192  # nodes that `spread` chooses from: every so many-th of more
NEAREST = 16  # nodes looked at for another part that touches


class SurfaceGraph:
    """Nodes on a shape and the lengths of the links between them.

    Parameters
    ----------
    x : (n, d) float64
        Vertices, in halves of the shape's longest side.
    faces : (f, 3) integers, or None for a cloud of points

    Raises
    ------
    ArgumentError
        A face names no vertex.
    NeuralMLSError
        SciPy is not installed.

    Examples
    --------
    >>> horseshoe = np.array([[0.0, 0], [0, 1], [0.04, 1], [0.04, 0]])
    >>> graph = SurfaceGraph(horseshoe, np.array([[0, 1, 1], [1, 2, 2], [2, 3, 3]]))
    >>> graph.distances(horseshoe[:1])[0, graph.nearest(horseshoe)[3]].round(1)   # not 0.04
    np.float64(2.0)
    """

    def __init__(self, x: Array, faces: NDArray[Any] | None) -> None:
        self.nodes, triangles = _merged(x, faces)
        self.nodes, triangles = _divided(self.nodes, triangles)
        links = [_two_steps(_edges(triangles), len(self.nodes))]
        loose = np.setdiff1d(np.arange(len(self.nodes)), triangles)
        links.append(_neighbours(self.nodes, loose))
        self._links = np.concatenate(links)
        self._links = np.concatenate([self._links, _touching(self.nodes, self._parts())])
        while (parts := self._parts()).any():
            self._links = np.concatenate([self._links, _nearest_pairs(self.nodes, parts)])

    def distances(self, p: Array) -> Array:
        """Return the lengths of the shortest paths from the points `p` (m, d) to every node: (m, nodes).

        A point off the shape starts from the nodes near it: all that are at most half as far again as the nearest.
        """
        count, m = len(self.nodes), len(p)
        near, far = _tree(self.nodes).query(p, k=min(64, count))[::-1]
        near, far = near.reshape(m, -1), far.reshape(m, -1)
        start = far <= 1.5 * far[:, :1] + 1e-9
        starts = np.stack([np.nonzero(start)[0] + count, near[start]], axis=1)
        links = np.concatenate([self._links, self._links[:, ::-1], starts])
        ends = np.concatenate([self.nodes, p])
        graph = self._matrix(links, np.linalg.norm(ends[links[:, 0]] - ends[links[:, 1]], axis=1), count + m)
        return np.asarray(scipy("sparse.csgraph").dijkstra(graph, indices=np.arange(count, count + m))[:, :count])

    def nearest(self, x: Array) -> Indices:
        """Return the node nearest to each of the points (k, d)."""
        return np.asarray(_tree(self.nodes).query(x)[1])

    def spread(self, count: int) -> Indices:
        """Return nodes spread evenly over the shape, `count` or all of them."""
        few = np.arange(0, len(self.nodes), -(-len(self.nodes) // MOST_SPREAD))
        return np.asarray(few[farthest_of(self.nodes[few], count)])

    def _parts(self) -> NDArray[np.int32]:
        """The number of the connected part of each node, the largest part being 0."""
        graph = self._matrix(self._links, np.ones(len(self._links)), len(self.nodes))
        parts = scipy("sparse.csgraph").connected_components(graph, directed=False)[1]
        order = np.argsort(np.argsort(-np.bincount(parts), kind="stable"), kind="stable")
        return np.asarray(order[parts], dtype=np.int32)

    def _matrix(self, links: Indices, lengths: Array, count: int) -> Any:
        """As a sparse matrix; of links given twice, once."""
        keys, first = np.unique(links[:, 0] * count + links[:, 1], return_index=True)
        lengths = np.maximum(lengths[first], 1e-12)  # a zero would be no link
        return scipy("sparse").csr_array((lengths, (keys // count, keys % count)), shape=(count, count))


def scipy(module: str) -> Any:
    """Return a module of SciPy.

    Raises
    ------
    NeuralMLSError
        SciPy is not installed.
    """
    try:
        return import_module(f"scipy.{module}")
    except ImportError as error:
        raise NeuralMLSError(
            "shape-aware weights need SciPy, which is not installed: pip install 'neuralmls[shape-aware]'"
        ) from error


def _tree(nodes: Array) -> Any:
    return scipy("spatial").cKDTree(nodes)


def _merged(x: Array, faces: NDArray[Any] | None) -> tuple[Array, Indices]:
    """Vertices in one place made one, and the faces of them."""
    nodes, which = np.unique(np.round(x, 7) + 0.0, axis=0, return_inverse=True)
    if faces is None or np.size(faces) == 0:
        return nodes, np.empty((0, 3), dtype=np.int64)
    return nodes, which.reshape(-1)[as_triangles(faces, len(x))].astype(np.int64)


def _divided(x: Array, faces: Indices) -> tuple[Array, Indices]:
    """Triangles halved across their longest edges until none is longer than `SPACING`."""
    while len(x) < MOST:
        ends = np.stack([faces, np.roll(faces, -1, axis=1)], axis=2)
        lengths = np.linalg.norm(x[ends[:, :, 0]] - x[ends[:, :, 1]], axis=2)
        long = np.flatnonzero(lengths.max(axis=1, initial=0) > SPACING)
        if not len(long):
            break
        longest = lengths[long].argmax(axis=1)
        a, b, c = (faces[long, (longest + step) % 3] for step in range(3))
        edges, which = np.unique(np.sort(np.stack([a, b], axis=1), axis=1), axis=0, return_inverse=True)
        middle = which.reshape(-1) + len(x)
        x = np.concatenate([x, x[edges].mean(axis=1)])
        halves = np.concatenate([np.stack([a, middle, c], axis=1), np.stack([middle, b, c], axis=1)])
        faces = np.concatenate([np.delete(faces, long, axis=0), halves])
    return x, faces


def _edges(faces: Indices) -> Indices:
    return np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])


def _two_steps(links: Indices, count: int) -> Indices:
    """The links, and one between the ends of each two in succession: with them, paths need not zigzag."""
    both = np.concatenate([links, links[:, ::-1]])
    steps = scipy("sparse").csr_array((np.ones(len(both), dtype=np.int32), both.T), shape=(count, count))
    two = scipy("sparse").triu(steps @ steps + steps, k=1)
    return np.stack(two.nonzero(), axis=1).astype(np.int64)


def _neighbours(nodes: Array, loose: Indices) -> Indices:
    """Links of the points of a cloud to their nearest."""
    if not len(loose):
        return np.empty((0, 2), dtype=np.int64)
    near = _tree(nodes[loose]).query(nodes[loose], k=np.arange(2, NEIGHBOURS + 2))[1]
    links = np.stack([np.repeat(loose, near.shape[1]), np.append(loose, -1)[near.reshape(-1)]], axis=1)
    return links[links[:, 1] >= 0]  # fewer points than neighbours


def _touching(nodes: Array, parts: NDArray[np.int32]) -> Indices:
    """Links between nodes of different parts that touch."""
    if not parts.any():
        return np.empty((0, 2), dtype=np.int64)
    far, near = _tree(nodes).query(nodes, k=min(NEAREST, len(nodes)), distance_upper_bound=TOUCH)
    found = np.isfinite(far)
    found[found] = parts[near[found]] != np.broadcast_to(parts[:, None], near.shape)[found]
    return np.stack([np.nonzero(found)[0], near[found]], axis=1)


def _nearest_pairs(nodes: Array, parts: NDArray[np.int32]) -> Indices:
    """For each part but the largest, a link to the nearest node that is not of it."""
    links = []
    for part in range(1, parts.max() + 1):
        own, others = np.flatnonzero(parts == part), np.flatnonzero(parts != part)
        far, near = _tree(nodes[others]).query(nodes[own])
        at = far.argmin()
        links.append([own[at], others[near[at]]])
    return np.array(links, dtype=np.int64)
