"""The sample car: a small hatchback; its moved control points make it longer and lower, its wheels stay wheels."""

from __future__ import annotations

import numpy as np

from neuralmls.control_points import ControlPoints
from neuralmls.samples.parts import Array, Part, line, loft, revolve, rounded, sheet, slab, sweep, welded
from neuralmls.samples.sample import Sample

AXLE_FRONT, AXLE_BACK, TRACK, RADIUS = 1.22, -1.22, 0.78, 0.31
# Sections of the body from the back to the front: z, floor, top, half width.
BODY = np.array([
    (-1.92, 0.42, 0.74, 0.66), (-1.86, 0.30, 0.86, 0.74), (-1.70, 0.24, 0.91, 0.79), (-1.2, 0.22, 0.93, 0.81),
    (-0.4, 0.20, 0.93, 0.82), (0.5, 0.20, 0.92, 0.82), (0.95, 0.21, 0.89, 0.81), (1.4, 0.22, 0.80, 0.79),
    (1.72, 0.25, 0.70, 0.75), (1.88, 0.30, 0.62, 0.69), (1.94, 0.38, 0.54, 0.62),
])  # fmt: skip
# Sections of the cabin: z, top, half width above.
CABIN = np.array([
    (-1.82, 0.84, 0.62), (-1.78, 0.97, 0.64), (-1.62, 1.22, 0.60), (-1.38, 1.40, 0.575), (-0.9, 1.47, 0.57),
    (-0.3, 1.48, 0.57), (0.1, 1.44, 0.57), (0.42, 1.30, 0.59), (0.72, 1.10, 0.63), (1.0, 0.90, 0.68),
    (1.12, 0.83, 0.70),
])  # fmt: skip
BELT, WAIST = 0.80, 0.775  # height of the cabin's foot and its half width there
SHOULDER = 0.12  # radius of the cabin where its sides meet the roof


def make() -> Sample:
    """The car: front is +z."""
    parts = [_body(), _cabin(), _windscreen(), _rear_window(), _spoiler()]
    for end, z, y in (("front", 1.9, 0.36), ("back", -1.88, 0.38)):
        parts.append(
            slab(
                f"{end}-bumper",
                "trim",
                (0, y, z),
                (1.42, 0.14, 0.17),
                radius=0.07,
                bevel=0.03,
                sides=8,
                rings=2,
            )
        )
    left = [_side_window(), _mirror()]
    for end, z in (("front", AXLE_FRONT), ("back", AXLE_BACK)):
        left += [_tyre(f"{end}-left-tyre", z), _rim(f"{end}-left-rim", z), _arch(f"{end}-left-arch", z)]
    left.append(_lamp("left-headlamp", "lamp", (0.5, 0.6, 1.815), (0.3, 0.1, 0.15), 68, 22))
    left.append(_lamp("left-tail-lamp", "red", (0.6, 0.7, -1.87), (0.16, 0.1, 0.24), -80, 12))
    parts.append(_lamp("grille", "trim", (0, 0.5, 1.925), (0.72, 0.06, 0.09), 80, 0))
    for part in left:
        parts += [part, part.mirrored(part.name.replace("left", "right"))]
    materials = {
        "paint": (0.25, 0.52, 0.47), "glass": (0.12, 0.15, 0.19), "trim": (0.20, 0.21, 0.23),
        "rubber": (0.11, 0.11, 0.12), "alloy": (0.72, 0.73, 0.75), "lamp": (0.93, 0.92, 0.84),
        "red": (0.45, 0.04, 0.06),
    }  # fmt: skip
    return Sample("car", parts, materials, _control_points())


def _smooth(table: Array, spans: int) -> Array:
    """The rows of a table, interpolated along its first column by Catmull and Rom's curve."""
    rows = np.concatenate([2 * table[:1] - table[1:2], table, 2 * table[-1:] - table[-2:-1]])
    out = []
    for k in range(1, len(rows) - 2):
        a, b, c, d = rows[k - 1 : k + 3]
        t = np.arange(spans)[:, None] / spans
        out.append(0.5 * (2 * b + (c - a) * t + (2 * a - 5 * b + 4 * c - d) * t**2 + (3 * b - a - 3 * c + d) * t**3))
    return np.concatenate([*out, table[-1:]])


def _body() -> Part:
    sections = []
    for z, floor, top, half in _smooth(BODY, 4):
        high = top - floor
        flat = rounded(2 * half, high, min(0.13, high * 0.4), sides=6, corner=4)
        bulge = 1.0 + 0.035 * (1 - (flat[:, 1] / high * 2) ** 2)
        sections.append(np.stack([flat[:, 0] * bulge, (floor + top) / 2 + flat[:, 1], np.full(len(flat), z)], axis=1))
    return loft("body", "paint", np.array(sections), rings=2)


def _cabin_section(top: float, half: float) -> Array:
    """An arch from the right foot of the cabin over the roof to the left one, (n, 2)."""
    height = max(top - BELT, 0.02)
    radius = min(SHOULDER, 0.45 * height)
    foot = WAIST if top > 0.9 else half  # the ends sink into the body
    wall = line((-foot, BELT, 0), (-half, top - radius, 0), 5)[:-1, :2]
    angle = np.linspace(np.pi, np.pi / 2, 5)[:, None]
    bend = np.array([-half + radius, top - radius]) + radius * np.concatenate([np.cos(angle), np.sin(angle)], axis=1)
    roof = line((*bend[-1], 0), (0, top + 0.015, 0), 6)[1:, :2]
    right = np.concatenate([wall, bend, roof])
    return np.concatenate([right, right[-2::-1] * [-1, 1]])


def _cabin() -> Part:
    """The cabin's skin: an open sheet that stands in the body."""
    grid = []
    for z, top, half in _smooth(CABIN, 4):
        arch = _cabin_section(top, half)
        grid.append(np.concatenate([arch, np.full((len(arch), 1), z)], axis=1))
    return sheet("cabin", "paint", np.array(grid)[:, ::-1])


def _pane(name: str, corners: list[tuple[float, float, float]], a: int, b: int, bulge: Array) -> Part:
    """A window through four corners, bulged in the middle."""
    p = np.array(corners)
    u, v = np.linspace(0, 1, b)[None, :, None], np.linspace(0, 1, a)[:, None, None]
    grid = (p[0] * (1 - u) + p[1] * u) * (1 - v) + (p[3] * (1 - u) + p[2] * u) * v
    return sheet(name, "glass", grid + bulge * (16 * u * (1 - u) * v * (1 - v)))


def _windscreen() -> Part:
    corners = [(-0.60, 0.93, 1.0), (0.60, 0.93, 1.0), (0.50, 1.38, 0.31), (-0.50, 1.38, 0.31)]
    return _pane("windscreen", corners, 9, 15, np.array([0.0, 0.035, 0.03]))


def _rear_window() -> Part:
    corners = [(0.56, 1.0, -1.80), (-0.56, 1.0, -1.80), (-0.48, 1.33, -1.555), (0.48, 1.33, -1.555)]
    return _pane("rear-window", corners, 7, 13, np.array([0.0, 0.02, -0.035]))


def _side_window() -> Part:
    """Two panes that share the line of the post between them, and a strip on it: edges of three faces."""
    front = _side_pane([(0.66, 0.93), (-0.3, 0.93), (-0.3, 1.27), (0.2, 1.27)], 7, 9)
    back = _side_pane([(-0.3, 0.93), (-1.42, 0.93), (-1.27, 1.27), (-0.3, 1.27)], 7, 9)
    post = front.vertices[front.vertices[:, 2] < -0.2999]
    return welded(
        "left-windows",
        "glass",
        [front, back, sheet("post", "glass", np.stack([post, post + np.array([0.02, 0.0, 0.0])]))],
    )


def _side_pane(corners: list[tuple[float, float]], a: int, b: int) -> Part:
    """A pane through four corners (z, y), laid on the cabin's left wall."""
    p = np.array(corners)
    u, v = np.linspace(0, 1, b)[None, :, None], np.linspace(0, 1, a)[:, None, None]
    z, y = np.moveaxis((p[0] * (1 - u) + p[1] * u) * (1 - v) + (p[3] * (1 - u) + p[2] * u) * v, -1, 0)
    cabin = _smooth(CABIN, 4)
    top, half = (np.interp(z, cabin[:, 0], cabin[:, k]) for k in (1, 2))
    up = (y - BELT) / (top - np.minimum(SHOULDER, 0.45 * (top - BELT)) - BELT)
    return sheet("pane", "glass", np.stack([WAIST + (half - WAIST) * up + 0.012, y, z], axis=-1))


def _tyre(name: str, z: float) -> Part:
    flat = rounded(0.2, 0.12, 0.045, sides=2, corner=3)
    return revolve(name, "rubber", flat + np.array([0.0, RADIUS - 0.06]), (TRACK, RADIUS, z), count=36)


def _rim(name: str, z: float) -> Part:
    """A dish with five spokes and a hub."""
    inner = RADIUS - 0.1
    ring = revolve(
        "ring",
        "alloy",
        [(0.09, inner), (0.09, inner + 0.02), (-0.06, inner + 0.02), (-0.06, inner)],
        (0, 0, 0),
        count=36,
    )
    dish = revolve("dish", "alloy", [(0.0, 0.0), (0.0, inner), (-0.02, inner), (-0.02, 0.0)], (0, 0, 0), count=36)
    hub = revolve(
        "hub",
        "alloy",
        [(0.085, 0.0), (0.08, 0.035), (0.03, 0.05), (0.0, 0.05), (0.0, 0.0)],
        (0, 0, 0),
        count=20,
    )
    parts = [ring, dish, hub]
    for k in range(5):
        spoke = sweep(
            "spoke",
            "alloy",
            line((0.06, 0.03, 0), (0.075, inner + 0.01, 0), 5),
            rounded(0.05, 0.03, 0.008, sides=2, corner=1),
            side=(0, 0, 1),
        )
        parts.append(spoke.rotated("x", 72.0 * k))
    return welded(name, "alloy", parts).moved((TRACK, RADIUS, z))


def _arch(name: str, z: float) -> Part:
    """A dark wheel well with a lip, an open sheet."""
    angle = np.radians(np.linspace(-18, 198, 29))
    rims = []
    for x, radius in (
        (0.852, 0.05),
        (0.852, RADIUS + 0.045),
        (0.872, RADIUS + 0.05),
        (0.866, RADIUS + 0.08),
        (0.81, RADIUS + 0.085),
    ):
        rims.append(np.stack([np.full(29, x), RADIUS + radius * np.sin(angle), z + radius * np.cos(angle)], axis=1))
    return sheet(name, "trim", np.array(rims))


def _mirror() -> Part:
    return slab(
        "left-mirror",
        "paint",
        (0.86, 0.97, 0.58),
        (0.15, 0.1, 0.09),
        radius=0.035,
        bevel=0.025,
        sides=3,
        rings=1,
    )


def _lamp(
    name: str,
    material: str,
    centre: tuple[float, float, float],
    size: tuple[float, float, float],
    tilt: float,
    turn: float,
) -> Part:
    part = slab(name, material, centre, size, radius=0.04, bevel=0.02, sides=4, rings=2, arc=2)
    return part.rotated("x", tilt, centre).rotated("y", turn, centre)


def _spoiler() -> Part:
    blade = slab("spoiler", "paint", (0, 1.40, -1.52), (1.08, 0.03, 0.2), radius=0.04, bevel=0.01, sides=12, rings=2)
    return blade.rotated("x", 8, (0, 1.40, -1.52))


def _control_points() -> ControlPoints:
    names = ["front-bumper", "bonnet", "roof-front", "roof-back", "back-bumper"]
    sources = [(0.0, 0.36, 1.95), (0.0, 0.86, 1.15), (0.0, 1.45, 0.1), (0.0, 1.44, -1.3), (0.0, 0.4, -1.94)]
    targets = [(0.0, 0.36, 2.4), (0.0, 0.82, 1.55), (0, 1.28, 0.15), (0, 1.22, -1.75), (0, 0.4, -2.5)]
    for side, sign in (("left", 1.0), ("right", -1.0)):
        names += [f"front-{side}-wheel", f"back-{side}-wheel", f"{side}-sill", f"{side}-mirror"]
        sources += [
            (sign * TRACK, RADIUS, AXLE_FRONT),
            (sign * TRACK, RADIUS, AXLE_BACK),
            (sign * 0.8, 0.3, 0.0),
            (sign * 0.86, 0.97, 0.58),
        ]
        targets += [
            (sign * TRACK, RADIUS, AXLE_FRONT + 0.35),
            (sign * TRACK, RADIUS, AXLE_BACK - 0.4),
            (sign * 0.8, 0.3, 0.0),
            (sign * 0.86, 0.92, 0.75),
        ]
    return ControlPoints(np.array(sources, dtype=float), np.array(targets, dtype=float), names)
