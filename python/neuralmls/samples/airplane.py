"""The sample airplane: a small airliner; its moved control points give it longer, swept wings and a taller fin."""

from __future__ import annotations

import numpy as np

from neuralmls.control_points import ControlPoints
from neuralmls.samples.parts import Array, Part, circle, line, loft, revolve, sheet, sweep, welded, wing
from neuralmls.samples.sample import Sample

# Sections of the body from nose to tail: z, height of the middle, half width, half height.
BODY = np.array([
    (11.0, -0.25, 0.02, 0.02), (10.8, -0.22, 0.35, 0.33), (10.3, -0.16, 0.72, 0.68), (9.4, -0.06, 1.12, 1.08),
    (8.2, 0.0, 1.38, 1.38), (6.8, 0.0, 1.5, 1.5), (-4.0, 0.0, 1.5, 1.5), (-6.5, 0.12, 1.32, 1.36),
    (-9.0, 0.45, 0.9, 0.98), (-11.0, 0.8, 0.5, 0.58), (-12.2, 1.0, 0.2, 0.24), (-12.4, 1.03, 0.08, 0.1),
])  # fmt: skip
WING_TIP = (10.5, 0.75, -2.6)
TAIL_TIP = (4.1, 1.35, -12.0)
FIN_TIP = (0.0, 5.2, -12.1)
ENGINE = (3.7, -1.25, 3.3)


def make() -> Sample:
    """The airplane: the nose is at +z, the wings reach along x."""
    halves = [
        wing(
            "left-wing",
            "white",
            [((0.4, -0.75, 3.6), 5.6), ((3.7, -0.35, 1.9), 3.6), (WING_TIP, 1.3)],
            0.12,
            spans=14,
        ),
        wing("left-tailplane", "white", [((0.1, 0.95, -8.8), 2.8), (TAIL_TIP, 1.1)], 0.10, spans=14),
        _winglet(),
        _engine(),
        sweep(
            "left-pylon",
            "white",
            line((3.7, -1.1, 1.3), (3.7, -0.42, 1.3), 6),
            _oval(0.12, 0.75),
            side=(1, 0, 0),
        ),
        _windows(),
    ]
    parts = [_fuselage(), _cockpit()]
    parts.append(wing("fin", "blue", [((0, 1.0, -7.4), 3.8), (FIN_TIP, 1.5)], 0.09, spans=14, up=(-1, 0, 0)))
    for part in halves:
        parts += [part, part.mirrored(part.name.replace("left", "right"))]
    materials = {
        "white": (0.88, 0.89, 0.91), "blue": (0.13, 0.30, 0.58), "glass": (0.10, 0.13, 0.18),
        "metal": (0.55, 0.57, 0.60),
    }  # fmt: skip
    return Sample("airplane", parts, materials, _control_points())


def _body_at(z: Array) -> tuple[Array, Array, Array]:
    """Height of the middle, half width and half height of the body at some z."""
    table = BODY[::-1]
    middle, wide, high = (np.interp(z, table[:, 0], table[:, k]) for k in (1, 2, 3))
    return middle, wide, high


def _fuselage() -> Part:
    dense = np.unique(np.concatenate([BODY[:, 0], np.linspace(11.0, -12.4, 48)]))
    middle, wide, high = _body_at(dense)
    ring = circle(1.0, 28)
    sections = np.stack([
        np.stack([ring[:, 0] * w, m + ring[:, 1] * h, np.full(len(ring), z)], axis=1)
        for z, m, w, h in zip(dense, middle, wide, high, strict=True)
    ])  # fmt: skip
    return loft("fuselage", "white", sections)


def _patch(z: Array, degrees: Array, lift: float) -> Array:
    """A grid of places on the body: angle from the left side upwards, lifted off it a little."""
    middle, wide, high = (value[:, None] for value in _body_at(z))
    angle = np.radians(degrees)[None]
    x, y = (wide + lift) * np.cos(angle), middle + (high + lift) * np.sin(angle)
    return np.stack([x, y, np.broadcast_to(z[:, None], x.shape)], axis=-1)


def _cockpit() -> Part:
    return sheet("cockpit", "glass", _patch(np.linspace(9.9, 8.95, 5), np.linspace(145, 35, 15), 0.025))


def _windows() -> Part:
    """A row of open sheets along one side."""
    panes = []
    for z in np.arange(7.0, -4.6, -0.72):
        panes.append(sheet("pane", "glass", _patch(np.linspace(z, z - 0.32, 3), np.linspace(26, 11, 3), 0.015)))
    return welded("left-windows", "glass", panes)


def _winglet() -> Part:
    """A sheet on the wing's tip, and a fence below it: all three panels share the tip's line."""
    x, y, z = WING_TIP
    chord = line((x, y, z - 0.1), (x, y, z - 1.3), 6)
    up = line((x + 0.35, y + 1.25, z - 1.0), (x + 0.35, y + 1.25, z - 1.7), 6)
    down = line((x + 0.08, y - 0.4, z - 0.6), (x + 0.08, y - 0.4, z - 1.3), 6)
    inner = chord + np.array([-0.6, -0.1, 0.3])  # within the wing
    panels = [
        sheet("panel", "blue", chord + (edge - chord) * np.linspace(0, 1, k)[:, None, None])
        for edge, k in ((up, 7), (down, 4), (inner, 4))
    ]
    return welded("left-winglet", "blue", panels)


def _engine() -> Part:
    """A nacelle, open in front and behind, and a spinner within."""
    outside = [(0.0, 0.74), (0.12, 0.83), (0.5, 0.9), (1.1, 0.9), (1.9, 0.8), (2.6, 0.62)]
    inside = [(2.6, 0.58), (1.9, 0.66), (1.0, 0.7), (0.3, 0.68)]
    profile = np.array([(-along, radius) for along, radius in outside + inside])
    # revolve turns about x; here the axis is z
    nacelle = revolve("nacelle", "metal", profile, (0, 0, 0), count=28).rotated("y", -90)
    disc = revolve("fan", "metal", [(-0.55, 0.0), (-0.55, 0.7), (-0.62, 0.7), (-0.62, 0.0)], (0, 0, 0), count=28)
    cone = revolve("spinner", "metal", [(-0.15, 0.0), (-0.3, 0.13), (-0.55, 0.22), (-0.55, 0.0)], (0, 0, 0), count=28)
    engine = welded("left-engine", "metal", [nacelle, disc.rotated("y", -90), cone.rotated("y", -90)])
    return engine.moved(ENGINE)


def _oval(width: float, length: float) -> Array:
    return circle(1.0, 16) * [width, length]


def _control_points() -> ControlPoints:
    names = ["nose", "body-front", "body-middle", "body-back", "tail", "fin-tip"]
    sources = [(0.0, -0.25, 10.9), (0.0, 0.0, 6.0), (0, 0, 0.8), (0, 0.12, -6.0), (0, 1.0, -12.2), (0, 5.2, -12.8)]
    targets = [*sources[:5], (0, 6.6, -13.9)]
    for side, sign in (("left", 1.0), ("right", -1.0)):
        names += [f"{side}-wing-tip", f"{side}-engine", f"{side}-tailplane-tip"]
        sources += [(sign * 10.5, 0.75, -3.2), (sign * 3.7, -1.25, 2.0), (sign * 4.1, 1.35, -12.5)]
        targets += [(sign * 13.2, 1.9, -5.6), (sign * 3.7, -1.25, 2.0), (sign * 4.9, 1.6, -13.2)]
    return ControlPoints(np.array(sources, dtype=float), np.array(targets, dtype=float), names)
