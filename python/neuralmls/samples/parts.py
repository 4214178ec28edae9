"""Parts that the sample shapes are put together from: lofts, sweeps, boxes, wheels, wings, open sheets.

Every part is a set of grids of quads, so that it bends, closed by n-gons. Parts overlap as manufactured shapes do;
nothing joins them but their place. Metres, y up.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


@dataclass
class Part:
    """A named piece of one material: vertices (n, 3), texture coordinates (t, 2), polygons as indices of both."""

    name: str
    material: str
    vertices: Array
    uvs: Array
    faces: list[list[int]]
    uv_faces: list[list[int]]

    def moved(self, offset: ArrayLike, name: str | None = None) -> Part:
        """The same part elsewhere."""
        vertices = self.vertices + np.asarray(offset, dtype=np.float64)
        return Part(name or self.name, self.material, vertices, self.uvs, self.faces, self.uv_faces)

    def mirrored(self, name: str) -> Part:
        """The same part on the other side of x = 0, its faces turned so that they still face outwards."""
        vertices = self.vertices * [-1.0, 1.0, 1.0]
        faces, uv_faces = ([face[::-1] for face in all_faces] for all_faces in (self.faces, self.uv_faces))
        return Part(name, self.material, vertices, self.uvs, faces, uv_faces)

    def rotated(self, axis: str, degrees: float, about: ArrayLike = (0, 0, 0)) -> Part:
        """The same part, turned about one of the axes x, y, z through a point."""
        centre = np.asarray(about, dtype=np.float64)
        vertices = (self.vertices - centre) @ rotation(axis, degrees).T + centre
        return Part(self.name, self.material, vertices, self.uvs, self.faces, self.uv_faces)


def rotation(axis: str, degrees: float) -> Array:
    """The rotation matrix (3, 3) about an axis."""
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    i, j = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
    matrix = np.eye(3)
    matrix[i, i], matrix[i, j], matrix[j, i], matrix[j, j] = c, -s, s, c
    return matrix


def welded(name: str, material: str, parts: list[Part]) -> Part:
    """One part of several: vertices at the same place (to a micrometre) become one."""
    vertices = np.concatenate([part.vertices for part in parts])
    keys = np.round(vertices, 6) + 0.0
    _, first, index = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    order = np.argsort(np.argsort(first))  # keep the order in which vertices first appear
    index = order[index.reshape(-1)]
    faces, uv_faces, vertex_base, uv_base = [], [], 0, 0
    for part in parts:
        for face, uv_face in zip(part.faces, part.uv_faces, strict=True):
            corners = [int(index[vertex_base + i]) for i in face]
            keep = [k for k in range(len(corners)) if corners[k] != corners[k - 1]]
            if len(keep) > 2:
                faces.append([corners[k] for k in keep])
                uv_faces.append([uv_base + uv_face[k] for k in keep])
        vertex_base, uv_base = vertex_base + len(part.vertices), uv_base + len(part.uvs)
    uvs = np.concatenate([part.uvs for part in parts])
    return Part(name, material, vertices[np.sort(first)], uvs, faces, uv_faces)


def sheet(name: str, material: str, grid: Array) -> Part:
    """An open patch through a grid of points (a, b, 3), with texture coordinates from 0 to 1 along both sides."""
    a, b = grid.shape[:2]
    index = np.arange(a * b).reshape(a, b)
    quads = np.stack([index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1]], axis=-1)
    faces = quads.reshape(-1, 4).tolist()
    v, u = np.meshgrid(np.linspace(0, 1, a), np.linspace(0, 1, b), indexing="ij")
    uvs = np.stack([u, v], axis=-1).reshape(-1, 2)
    return Part(name, material, grid.reshape(-1, 3).astype(np.float64), uvs, faces, [list(f) for f in faces])


def loft(name: str, material: str, sections: Array, *, caps: tuple[bool, bool] = (True, True), rings: int = 0) -> Part:
    """A skin through closed sections (k, n, 3), anticlockwise as seen from the last one looking back.

    Ends are closed by one n-gon each, after `rings` rings of quads that shrink towards the middle, so that a
    large end can bend too.
    """
    pieces = [sheet(name, material, np.concatenate([sections, sections[:, :1]], axis=1))]
    for wanted, section, flip in zip(caps, (sections[0], sections[-1]), (True, False), strict=True):
        if wanted:
            pieces.append(_cap(name, material, section[::-1] if flip else section, rings))
    return welded(name, material, pieces)


def _cap(name: str, material: str, outline: Array, rings: int) -> Part:
    centre, count = outline.mean(axis=0), len(outline)
    scales = np.linspace(1.0, 0.05, rings + 1)[:, None, None] if rings else np.ones((1, 1, 1))
    grid = centre + (outline - centre) * scales
    span = np.ptp(outline, axis=0)
    axes = np.sort(np.argsort(span)[1:])  # lay the texture over the two directions that the end extends in
    points = grid.reshape(-1, 3)
    uvs = (points[:, axes] - outline[:, axes].min(axis=0)) / np.maximum(span[axes], 1e-9)
    index = np.arange(len(points)).reshape(rings + 1, count)
    after = np.roll(index, -1, axis=1)
    faces = np.stack([index[:-1], after[:-1], after[1:], index[1:]], axis=-1).reshape(-1, 4).tolist()
    faces.append(index[-1].tolist())
    return Part(name, material, points, uvs, faces, [list(face) for face in faces])


def rounded(width: float, depth: float, radius: float, *, sides: int = 4, corner: int = 3) -> Array:
    """A rectangle with rounded corners about the origin, (n, 2), anticlockwise; `sides` spans along each side."""
    a, b = width / 2 - radius, depth / 2 - radius
    points: list[Array] = []
    for k, (x, y) in enumerate([(a, b), (-a, b), (-a, -b), (a, -b)]):
        angle = np.linspace(k, k + 1, corner + 1)[:, None] * np.pi / 2
        points.append(np.array([x, y]) + radius * np.concatenate([np.cos(angle), np.sin(angle)], axis=1))
    outline = []
    for k in range(4):
        start, end = points[k][-1], points[(k + 1) % 4][0]
        between = np.linspace(0, 1, sides + 1)[1:-1, None]
        outline += [points[k], start + (end - start) * between]
    return np.concatenate(outline)


def circle(radius: float, count: int = 16) -> Array:
    """A circle about the origin, (count, 2), anticlockwise."""
    angle = np.arange(count) / count * 2 * np.pi
    return radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)


def sweep(
    name: str,
    material: str,
    path: ArrayLike,
    outline: Array,
    *,
    scale: ArrayLike = 1.0,
    side: ArrayLike = (1, 0, 0),
) -> Part:
    """An outline (n, 2) swept along a path (k, 3); `side` is where the outline's first axis points, about.

    `scale` is one number for each point of the path, or two: one for each axis of the outline.
    """
    points = np.asarray(path, dtype=np.float64)
    along = np.gradient(points, axis=0)
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    first = np.asarray(side, dtype=np.float64) - along * (along @ np.asarray(side, dtype=np.float64))[:, None]
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    second = np.cross(along, first)
    scales = np.asarray(scale, dtype=np.float64)
    scales = np.broadcast_to(scales[:, None] if scales.ndim == 1 else scales, (len(points), 2))
    spread = outline[None] * scales[:, None]
    sections = points[:, None] + spread[..., :1] * first[:, None] + spread[..., 1:] * second[:, None]
    return loft(name, material, sections)


def line(start: ArrayLike, end: ArrayLike, spans: int) -> Array:
    """Points on a straight line, (spans + 1, 3)."""
    a, b = np.asarray(start, dtype=np.float64), np.asarray(end, dtype=np.float64)
    return a + (b - a) * np.linspace(0, 1, spans + 1)[:, None]


def curve(controls: ArrayLike, spans: int) -> Array:
    """Points on the Bezier curve of some control points, (spans + 1, 3)."""
    points = np.repeat(np.asarray(controls, dtype=np.float64)[None], spans + 1, axis=0)
    t = np.linspace(0, 1, spans + 1)[:, None, None]
    while points.shape[1] > 1:
        points = points[:, :-1] * (1 - t) + points[:, 1:] * t
    return np.ascontiguousarray(points[:, 0])


def slab(
    name: str,
    material: str,
    centre: ArrayLike,
    size: ArrayLike,
    *,
    radius: float,
    bevel: float,
    sides: int = 8,
    rings: int = 4,
    arc: int = 1,
) -> Part:
    """A flat board with rounded corners, its thickness along y, its edges bevelled in `arc` steps."""
    (width, height, depth), middle = np.asarray(size, dtype=np.float64), np.asarray(centre, dtype=np.float64)
    turn = np.linspace(np.pi / 2, 0, arc + 1)
    edge = [(height / 2 - bevel * (1 - np.sin(t)), bevel * (1 - np.cos(t))) for t in turn]
    sections = []
    for level, inset in [(-level, inset) for level, inset in edge] + [(0.0, 0.0)] + edge[::-1]:
        flat = rounded(width - 2 * inset, depth - 2 * inset, max(radius - inset, bevel / 4), sides=sides)
        section = np.stack([flat[:, 0], np.full(len(flat), level), -flat[:, 1]], axis=1)
        sections.append(middle + section)
    return loft(name, material, np.array(sections), rings=rings)


def revolve(name: str, material: str, profile: ArrayLike, centre: ArrayLike, *, count: int = 32) -> Part:
    """A closed profile (k, 2) of (x, radius) turned about the x axis through a centre: a tyre, a hub."""
    flat = np.asarray(profile, dtype=np.float64)
    x, radius = flat.T
    if (x * np.roll(radius, -1) - radius * np.roll(x, -1)).sum() > 0:
        flat = flat[::-1]  # clockwise, so that faces look outwards
    angle = np.arange(count + 1) / count * 2 * np.pi
    x = np.repeat(flat[:, :1], count + 1, axis=1)
    grid = np.stack([x, flat[:, 1:] * np.cos(angle), flat[:, 1:] * np.sin(angle)], axis=-1)
    grid = np.concatenate([grid, grid[:1]])
    return welded(name, material, [sheet(name, material, grid + np.asarray(centre, dtype=np.float64))])


def aerofoil(chord: float, thickness: float, count: int = 12) -> Array:
    """A symmetric wing section, (2 count, 2): from the trailing edge over the top to the nose and back below.

    NACA four-digit thickness, closed at the trailing edge; the nose is at (0, 0), the trailing edge at (chord, 0).
    """
    t = (1 + np.cos(np.linspace(0, np.pi, count + 1))) / 2
    y = 5 * thickness * (0.2969 * np.sqrt(t) - 0.126 * t - 0.3516 * t**2 + 0.2843 * t**3 - 0.1036 * t**4)
    upper = np.stack([t, y], axis=1)
    return np.concatenate([upper, upper[-2:0:-1] * [1, -1]]) * chord


def wing(
    name: str,
    material: str,
    stations: list[tuple[ArrayLike, float]],
    thickness: float,
    *,
    spans: int,
    up: ArrayLike = (0, 1, 0),
) -> Part:
    """Wing sections lofted through stations (place of the nose of the section, chord); the chord runs along -z."""
    noses = np.array([np.asarray(nose, dtype=np.float64) for nose, _ in stations])
    chords = np.array([chord for _, chord in stations])
    knots = np.linspace(0, 1, len(stations))
    at = np.linspace(0, 1, spans * (len(stations) - 1) + 1)
    unit, upward = aerofoil(1.0, thickness), np.asarray(up, dtype=np.float64)
    sections = []
    for t in at:
        nose = np.array([np.interp(t, knots, noses[:, axis]) for axis in range(3)])
        flat = unit * np.interp(t, knots, chords)
        sections.append(nose + flat[:, :1] * np.array([0.0, 0.0, -1.0]) + flat[:, 1:] * upward)
    return loft(name, material, np.array(sections))
