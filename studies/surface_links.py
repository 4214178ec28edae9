"""The links of a surface, whatever it is made of: which places are next to each other, and how well a link conducts.

Vertices in one place are one node, and long edges are halved. An edge conducts as the strip of surface along it does:
half the sum of the cotangents of the angles that face it. Near parts of one component are never linked; components that
touch or overlap are joined by short links, and what is left by its nearest pair of nodes, so that every place can be
reached from every other. Points of a cloud, and vertices without a face, are linked to their nearest neighbours.

At last all nodes of one connected patch in a small cell become one: a fine mesh is then as cheap as a coarse one.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

CELL = 0.02  # side of a cell, in halves of the shape's longest side
SPACING = 0.06  # longest edge
TOUCH = 0.03  # components nearer than this touch
MOST = 40_000  # nodes: long edges are no longer halved beyond
NEIGHBOURS = 8  # of a point of a cloud
NEAREST = 16  # nodes looked at for another component that touches
EVEN = 0.5  # what a link that is no edge conducts: about as much as an edge between even triangles
LEAST = 0.01  # what every edge conducts, also where triangles are so obtuse that the cotangents say less than nothing
MOST_COTANGENT = 10.0


class Links(NamedTuple):
    """Nodes (n, d), each link once by its two nodes (k, 2), and what it conducts (k,)."""

    nodes: Array
    ends: Indices
    conductances: Array

    def lengths(self) -> Array:
        """How long each link is."""
        return np.asarray(np.linalg.norm(self.nodes[self.ends[:, 0]] - self.nodes[self.ends[:, 1]], axis=1))

    def areas(self) -> Array:
        """How much of the surface each node stands for: the part of each strip that is nearer to it."""
        quarter = 0.25 * self.conductances * self.lengths() ** 2
        return np.asarray(np.bincount(self.ends.reshape(-1), np.repeat(quarter, 2), len(self.nodes)), dtype=np.float64)

    def with_more(self, ends: Indices) -> Links:
        """With links that are no edges."""
        conductances = np.append(self.conductances, np.full(len(ends), EVEN))
        return Links(self.nodes, np.concatenate([self.ends, ends]), conductances)


def surface_links(x: Array, faces: NDArray[Any] | None) -> Links:
    """Return the links of a surface, of a soup, or (faces None) of a cloud of points.

    Parameters
    ----------
    x : (n, d) float64
        Vertices, in halves of the shape's longest side.
    faces : (f, 3) integers, or None


    Examples
    --------
    Two right angles face the diagonal of a square, and their cotangents are 0; halves of 1 face the sides.

    >>> square = np.array([[0.0, 0], [0.028, 0], [0.028, 0.028], [0, 0.028]])
    >>> links = surface_links(square, np.array([[0, 1, 2], [0, 2, 3]]))
    >>> dict(zip(map(tuple, links.ends.tolist()), links.conductances.round(3).tolist()))
    {(0, 1): 0.5, (0, 2): 0.5, (0, 3): 0.01, (1, 3): 0.5, (2, 3): 0.5}
    """
    nodes, triangles = _divided(*_merged(x, faces))
    links = Links(nodes, *_edges(nodes, triangles))
    links = links.with_more(_neighbours(nodes, np.setdiff1d(np.arange(len(nodes)), triangles)))
    links = links.with_more(_touching(nodes, _components(links)))
    while (components := _components(links)).any():
        links = links.with_more(_nearest_pairs(nodes, components))
    return _in_cells(links)


def nearest_to(nodes: Array) -> Any:
    """Return the tree of some nodes, that finds the nearest."""
    return cKDTree(nodes)


def _merged(x: Array, faces: NDArray[Any] | None) -> tuple[Array, Indices]:
    """Vertices in one place made one, and the faces of them."""
    nodes, which = np.unique(np.round(x, 7) + 0.0, axis=0, return_inverse=True)
    if faces is None or np.size(faces) == 0:
        return nodes, np.empty((0, 3), dtype=np.int64)
    return nodes, which.reshape(-1)[faces].astype(np.int64)


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


def _edges(x: Array, faces: Indices) -> tuple[Indices, Array]:
    """Each edge once, and half the sum of the cotangents of the angles that face it."""
    keys, cotangents = [], []
    for corner in range(3):
        apex, a, b = (faces[:, (corner + step) % 3] for step in range(3))
        u, v = x[a] - x[apex], x[b] - x[apex]
        dot = np.einsum("fk,fk->f", u, v)
        area = np.sqrt(np.maximum(np.einsum("fk,fk->f", u, u) * np.einsum("fk,fk->f", v, v) - dot**2, 1e-24))
        cotangents.append(0.5 * np.clip(dot / area, -MOST_COTANGENT, MOST_COTANGENT))
        keys.append(np.minimum(a, b) * len(x) + np.maximum(a, b))
    ends, conductances = _summed(np.concatenate(keys), np.concatenate(cotangents), len(x))
    return ends, np.maximum(conductances, LEAST)


def _summed(keys: Indices, values: Array, count: int) -> tuple[Indices, Array]:
    """Links from `key // count` to `key % count`, of those given twice the sum; none from a node to itself."""
    order = np.argsort(keys, kind="stable")
    keys = keys[order]
    first = np.flatnonzero(np.diff(keys, prepend=-1))
    sums = np.add.reduceat(values[order], first) if len(first) else np.empty(0)
    ends = np.stack([keys[first] // count, keys[first] % count], axis=1)
    between = ends[:, 0] != ends[:, 1]
    return ends[between], sums[between]


def _connected(ends: Indices, count: int) -> NDArray[np.int32]:
    """The number of the connected component of each node."""
    graph = csr_array((np.ones(len(ends), dtype=np.int8), ends.T), shape=(count, count))
    return np.asarray(connected_components(graph, directed=False)[1])


def _components(links: Links) -> NDArray[np.int32]:
    """The number of the connected component of each node, the largest being 0."""
    components = _connected(links.ends, len(links.nodes))
    order = np.argsort(np.argsort(-np.bincount(components), kind="stable"), kind="stable")
    return np.asarray(order[components], dtype=np.int32)


def _in_cells(links: Links) -> Links:
    """All nodes that are connected within a cell of a grid as one, in their middle.

    Two patches border on each other along the strips of all links between them, as wide as conductance x length.
    """
    x, ends, conductances = links
    cells = np.floor(x / CELL + 0.2718).astype(np.int64)  # no wall where coordinates of furniture are: 0, 1, halves
    within = (cells[ends[:, 0]] == cells[ends[:, 1]]).all(axis=1)
    patches = _connected(ends[within], len(x))
    count = int(patches.max()) + 1
    sizes = np.bincount(patches)
    nodes = np.stack([np.bincount(patches, column) / sizes for column in x.T], axis=1)
    a, b = patches[ends[~within]].T.astype(np.int64)
    widths = (conductances * links.lengths())[~within]
    between, width = _summed(np.minimum(a, b) * count + np.maximum(a, b), widths, count)
    merged = Links(nodes, between, width)
    return merged._replace(conductances=width / np.maximum(merged.lengths(), 0.1 * CELL))


def _neighbours(nodes: Array, loose: Indices) -> Indices:
    """Links of the points of a cloud to their nearest."""
    if not len(loose):
        return np.empty((0, 2), dtype=np.int64)
    near = nearest_to(nodes[loose]).query(nodes[loose], k=np.arange(2, NEIGHBOURS + 2))[1]
    links = np.stack([np.repeat(loose, near.shape[1]), np.append(loose, -1)[near.reshape(-1)]], axis=1)
    return links[links[:, 1] >= 0]  # fewer points than neighbours


def _touching(nodes: Array, components: NDArray[np.int32]) -> Indices:
    """Links between nodes of different components that touch."""
    if not components.any():
        return np.empty((0, 2), dtype=np.int64)
    far, near = nearest_to(nodes).query(nodes, k=min(NEAREST, len(nodes)), distance_upper_bound=TOUCH)
    found = np.isfinite(far)
    found[found] = components[near[found]] != np.broadcast_to(components[:, None], near.shape)[found]
    return np.stack([np.nonzero(found)[0], near[found]], axis=1)


def _nearest_pairs(nodes: Array, components: NDArray[np.int32]) -> Indices:
    """For each component but the largest, a link to the nearest node that is not of it."""
    links = []
    for component in range(1, components.max() + 1):
        own, others = np.flatnonzero(components == component), np.flatnonzero(components != component)
        far, near = nearest_to(nodes[others]).query(nodes[own])
        at = far.argmin()
        links.append([own[at], others[near[at]]])
    return np.array(links, dtype=np.int64)
