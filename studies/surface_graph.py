"""Walks over a shape, whatever it is made of: which control point a random one meets first; the shortest ones."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_array, csr_array, triu
from scipy.sparse.csgraph import dijkstra
from scipy.sparse.linalg import splu
from surface_links import CELL, Array, Indices, nearest_to, surface_links

from neuralmls.placement import farthest_of

MOST_SPREAD = 8192  # nodes that `spread` chooses from: every so many-th of more
MET = 1.5  # times as far as the nearest: the nodes at which a walk meets a control point
MOST_MET = 64  # such nodes
AROUND = 2.0  # times: those to which paths lead from it, for one in a body is not on one side of it only
MOST_AROUND = 512
FIRM = 1.0  # what links of a control point conduct, a cell away; on a node ten times as much
HOLD = 0.8  # of the way to the nearest other control point: how far one holds what is nearest to it
HELD = 0.5  # how firmly, by area over the square of the distance


class Reach(NamedTuple):
    """Shortest paths along a shape."""

    far: Array  # (nodes,): from each node to its nearest control point
    nearest: Indices  # (nodes,): which that is
    apart: Array  # (m,): from each control point to the nearest other; infinite where there is none


class SurfaceGraph:
    """Nodes on a shape and the links between them.

    Parameters
    ----------
    x : (n, d) float64
        Vertices, in halves of the shape's longest side.
    faces : (f, 3) integers, or None for a cloud of points

    Examples
    --------
    >>> horseshoe = np.array([[0.0, 0], [0, 1], [0.04, 1], [0.04, 0]])
    >>> graph = SurfaceGraph(horseshoe, np.array([[0, 1, 1], [1, 2, 2], [2, 3, 3]]))
    >>> end = graph.nearest(horseshoe)[3]
    >>> graph.reach(horseshoe[:1]).far[end].round(1)   # not 0.04
    np.float64(2.0)
    >>> p = horseshoe[[0, 2]]
    >>> graph.first_met(p, graph.reach(p))[end].round(2)   # the walk meets the nearer one along the shape
    array([0., 1.])
    """

    def __init__(self, x: Array, faces: NDArray[Any] | None) -> None:
        self._links = surface_links(x, faces)
        self.nodes = self._links.nodes

    def first_met(self, p: Array, reach: Reach, *, hold: float = HOLD, held: float = HELD) -> Array:
        """Return the probability that a random walk from each node meets each of `p` (m, d) before the others.

        The walk takes a link with a probability proportional to what it conducts: the result is the harmonic function
        `h_i` that is 1 at control point i and 0 at the others, (nodes, m), rows sum to 1. It knows how wide the shape
        is: a walk finds its way from a trunk into a thin leg seldom, and from the leg to the trunk soon.

        A control point is no needle, at which a harmonic function would be infinitely steep: it holds what is nearest
        to it (`reach`), less and less up to 0.8 of the way to the nearest other one, and a walk may end wherever it
        does.

        Source
        ------
        Doyle, Snell, "Random walks and electric networks", 1984; cotangents: Pinkall, Polthier, "Computing discrete
        minimal surfaces and their conjugates", 1993.
        """
        count, m = len(self.nodes), len(p)
        which, nodes, far = self._attached(p, MET, MOST_MET)
        firm = FIRM * CELL / (far + 0.1 * CELL)
        radius = hold * reach.apart[reach.nearest]
        around = np.flatnonzero(reach.far < radius)
        near = reach.far[around]
        density = held / (near**2 + CELL**2) * (1 - (near / radius[around]) ** 2) ** 2
        which, nodes = np.append(which, reach.nearest[around]), np.append(nodes, around)
        firm = np.append(firm, density * self._links.areas[around])
        (a, b), conducts = self._links.ends.T, self._links.conductances
        values = np.concatenate([-conducts, -conducts, conducts, conducts, firm])
        rows, columns = np.concatenate([a, b, a, b, nodes]), np.concatenate([b, a, a, b, nodes])
        laplacian = csc_array((values, (rows, columns)), shape=(count, count))
        sources = np.zeros((count, m))
        np.add.at(sources, (nodes, which), firm)
        # Symmetric and diagonally dominant: no pivots are needed.
        factors = splu(laplacian, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
        return np.asarray(factors.solve(sources))

    def reach(self, p: Array, *, around: float = AROUND) -> Reach:
        """Return the shortest paths from each node to the nearest of `p` (m, d), and between these.

        Those of a control point in the midst of a body lead straight to the surface around it.
        """
        count, m = len(self.nodes), len(p)
        which, nodes, _ = self._attached(p, around, MOST_AROUND)
        links = np.concatenate([_two_steps(self._links.ends, count), np.stack([which + count, nodes], axis=1)])
        a, b = links.T
        ends = np.concatenate([self.nodes, p])
        lengths = np.maximum(np.linalg.norm(ends[a] - ends[b], axis=1), 1e-12)  # a zero would be no link
        graph = csr_array((lengths, (a, b)), shape=(count + m, count + m))
        far, _, source = dijkstra(
            graph, directed=False, indices=np.arange(count, count + m), min_only=True, return_predecessors=True
        )
        # The shortest path to another of them crosses once from the nodes nearest to one to those nearest to the other.
        across = source[a] != source[b]
        apart = np.full(m, np.inf)
        for end in (a, b):
            np.minimum.at(apart, source[end[across]] - count, (far[a] + lengths + far[b])[across])
        return Reach(far[:count], source[:count] - count, apart)

    def distances(self, p: Array, *, around: float = AROUND) -> Array:
        """Return how far each of `p` (m, d) is from each node along the shape, past the others: (nodes, m)."""
        count = len(self.nodes)
        pairs = _two_steps(self._links.ends, count)
        which, nodes, away = self._attached(p, around, MOST_AROUND)
        lengths = np.maximum(np.linalg.norm(self.nodes[pairs[:, 0]] - self.nodes[pairs[:, 1]], axis=1), 1e-12)
        found = []
        for i in range(len(p)):
            own = which == i
            ends = np.append(pairs[:, 0], np.full(own.sum(), count)), np.append(pairs[:, 1], nodes[own])
            whole = np.append(lengths, np.maximum(away[own], 1e-12))
            graph = csr_array((whole, ends), shape=(count + 1, count + 1))
            found.append(dijkstra(graph, directed=False, indices=count)[:count])
        return np.stack(found, axis=1)

    def nearest(self, x: Array) -> Indices:
        """Return the node nearest to each of the points (k, d)."""
        return np.asarray(nearest_to(self.nodes).query(x)[1])

    def spread(self, count: int) -> Indices:
        """Return nodes spread evenly over the shape, `count` or all of them."""
        few = np.arange(0, len(self.nodes), -(-len(self.nodes) // MOST_SPREAD))
        return np.asarray(few[farthest_of(self.nodes[few], count)])

    def _attached(self, p: Array, times: float, most: int) -> tuple[Indices, Indices, Array]:
        """Links of points (m, d) to nodes at most so many times as far as the nearest, and their lengths."""
        far, near = nearest_to(self.nodes).query(p, k=min(most, len(self.nodes)))
        near, far = near.reshape(len(p), -1), far.reshape(len(p), -1)
        attached = far <= times * far[:, :1] + 1e-9
        return np.nonzero(attached)[0], near[attached], far[attached]


def _two_steps(links: Indices, count: int) -> Indices:
    """The links, and one between the ends of each two in succession: with them, paths need not zigzag."""
    both = np.concatenate([links, links[:, ::-1]])
    steps = csr_array((np.ones(len(both), dtype=np.int32), both.T), shape=(count, count))
    two = triu(steps @ steps + steps, k=1)
    return np.stack(two.nonzero(), axis=1).astype(np.int64)
