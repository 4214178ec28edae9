"""The links of a surface, whatever it is made of: which places are next to each other, and how well a link conducts.

The same as crates/core/src/weights/shape_graph, by NumPy and SciPy, which breaks ties between distances otherwise.

Vertices in one place are one node, and long edges are halved. An edge conducts as the strip of surface along it does:
half the sum of the cotangents of the angles that face it, in a triangle no more than its area says. Near parts of one
component are never linked; components that touch or overlap are joined by short links, and what is left by its nearest
pair of nodes, so that every place can be reached from every other. Points of a cloud, and vertices without a face, are
linked to their nearest neighbours.

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
NEAREST = 8  # nodes of other components to which one that touches is linked
EVEN = 0.5  # what a link that is no edge conducts: about as much as an edge between even triangles
LEAST = 0.01  # what every edge conducts, also where triangles are so obtuse that the cotangents say less than nothing
LEAST_AREA = 5e-13


class Links(NamedTuple):
    """Nodes (n, d), each link once by its two nodes (k, 2), what it conducts (k,), the area of each node (n,)."""

    nodes: Array
    ends: Indices
    conductances: Array
    areas: Array

    def lengths(self) -> Array:
        """How long each link is."""
        return np.asarray(np.linalg.norm(self.nodes[self.ends[:, 0]] - self.nodes[self.ends[:, 1]], axis=1))

    def with_more(self, ends: Indices, conduct: float | Array = EVEN) -> Links:
        """With links that are no edges."""
        conductances = np.append(self.conductances, np.broadcast_to(conduct, len(ends)))
        return self._replace(ends=np.concatenate([self.ends, ends]), conductances=conductances)


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
    areas = np.bincount(triangles.reshape(-1), np.repeat(_areas(nodes, triangles) / 3, 3), len(nodes))
    links = Links(nodes, *_edges(nodes, triangles), areas)
    near = _neighbours(nodes, np.setdiff1d(np.arange(len(nodes)), triangles))
    quarters = 0.25 * EVEN * ((nodes[near[:, 0]] - nodes[near[:, 1]]) ** 2).sum(axis=1)
    areas = areas + np.bincount(near.reshape(-1), np.repeat(quarters, 2), len(nodes))
    links = links._replace(areas=areas).with_more(near)
    touches = _touching(nodes, _components(links))
    links = links.with_more(touches, EVEN / np.bincount(touches[:, 0], minlength=len(nodes))[touches[:, 0]])
    while (components := _components(links)).any():
        links = links.with_more(_nearest_pairs(nodes, components))
    return _in_cells(links)


def nearest_to(nodes: Array) -> Any:
    """Return the tree of some nodes, that finds the nearest."""
    return cKDTree(nodes)


def _merged(x: Array, faces: NDArray[Any] | None) -> tuple[Array, Indices]:
    """Vertices in one place made one, and the faces of them, each once."""
    nodes, which = np.unique(np.round(x, 7) + 0.0, axis=0, return_inverse=True)
    if faces is None or np.size(faces) == 0:
        return nodes, np.empty((0, 3), dtype=np.int64)
    named = which.reshape(-1)[faces].astype(np.int64)
    corners = np.sort(named, axis=1)
    kept = (np.diff(corners, axis=1) > 0).any(axis=1)  # faces of two places, too: they hold these together
    named, corners = named[kept], corners[kept]
    return nodes, named[np.sort(np.unique(corners, axis=0, return_index=True)[1])]


def _divided(x: Array, faces: Indices) -> tuple[Array, Indices]:
    """Triangles halved across their longest edges until none is longer than `SPACING`; each edge has one middle."""
    middles: dict[tuple[int, int], int] = {}
    while len(x) < MOST:
        ends = np.stack([faces, np.roll(faces, -1, axis=1)], axis=2)
        lengths = np.linalg.norm(x[ends[:, :, 0]] - x[ends[:, :, 1]], axis=2)
        long = np.flatnonzero(lengths.max(axis=1, initial=0) > SPACING)
        if not len(long):
            break
        more, halves = [], []
        for face, longest in zip(faces[long].tolist(), lengths[long].argmax(axis=1), strict=True):
            a, b, c = (face[(longest + step) % 3] for step in range(3))
            edge = min(a, b), max(a, b)
            if edge not in middles:
                middles[edge] = len(x) + len(more)
                more.append((x[a] + x[b]) / 2)
            halves += [[a, middles[edge], c], [middles[edge], b, c]]
        x = np.concatenate([x, np.reshape(more, (-1, x.shape[1]))])
        faces = np.concatenate([np.delete(faces, long, axis=0), halves])
    return x, faces


def _areas(x: Array, faces: Indices) -> Array:
    """The area of each triangle."""
    u, v = (x[faces[:, corner]] - x[faces[:, 0]] for corner in (1, 2))
    square = (u**2).sum(axis=1) * (v**2).sum(axis=1) - (u * v).sum(axis=1) ** 2
    return np.asarray(0.5 * np.sqrt(np.maximum(square, 0)))


def _edges(x: Array, faces: Indices) -> tuple[Indices, Array]:
    """Each edge once, and what it conducts."""
    areas = _areas(x, faces)
    keys, halves, lengths = [], [], []
    for corner in range(3):
        apex, a, b = (faces[:, (corner + step) % 3] for step in range(3))
        dots = ((x[a] - x[apex]) * (x[b] - x[apex])).sum(axis=1)
        halves.append(0.5 * np.maximum(dots / (2 * np.maximum(areas, LEAST_AREA)), 0))
        lengths.append(((x[a] - x[b]) ** 2).sum(axis=1))
        keys.append(np.minimum(a, b) * len(x) + np.maximum(a, b))
    in_all = (np.array(halves) * lengths).sum(axis=0)
    parts = np.divide(2 * areas, in_all, out=np.ones(len(faces)), where=in_all > 2 * areas)
    ends, conductances = _summed(np.concatenate(keys), np.concatenate([parts * half for half in halves]), len(x))
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
    x, ends, conductances, areas = links
    cells = np.floor(x / CELL + 0.2718).astype(np.int64)  # no wall where coordinates of furniture are: 0, 1, halves
    within = (cells[ends[:, 0]] == cells[ends[:, 1]]).all(axis=1)
    patches = _connected(ends[within], len(x))
    count = int(patches.max()) + 1
    sizes = np.bincount(patches)
    nodes = np.stack([np.bincount(patches, column) / sizes for column in x.T], axis=1)
    a, b = patches[ends[~within]].T.astype(np.int64)
    widths = (conductances * links.lengths())[~within]
    between, width = _summed(np.minimum(a, b) * count + np.maximum(a, b), widths, count)
    merged = Links(nodes, between, width, np.bincount(patches, areas, count))
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
    links = [np.empty((0, 2), dtype=np.int64)]
    for component in range(1 + int(components.max()) if components.any() else 0):
        own, others = np.flatnonzero(components == component), np.flatnonzero(components != component)
        count = np.arange(1, min(NEAREST, len(others)) + 1)
        far, near = nearest_to(nodes[others]).query(nodes[own], k=count, distance_upper_bound=TOUCH)
        found = np.isfinite(far)
        links.append(np.stack([own[np.nonzero(found)[0]], others[near[found]]], axis=1))
    return np.concatenate(links)


def _nearest_pairs(nodes: Array, components: NDArray[np.int32]) -> Indices:
    """For each component but the largest, a link to the nearest node that is not of it."""
    links = []
    for component in range(1, components.max() + 1):
        own, others = np.flatnonzero(components == component), np.flatnonzero(components != component)
        far, near = nearest_to(nodes[others]).query(nodes[own])
        at = far.argmin()
        links.append([own[at], others[near[at]]])
    return np.array(links, dtype=np.int64)
