"""The sample table: tapered legs, a drawer, a shelf; its moved control points make it longer and higher."""

from __future__ import annotations

import numpy as np

from neuralmls.control_points import ControlPoints
from neuralmls.samples.parts import Part, circle, line, rounded, sheet, slab, sweep, welded
from neuralmls.samples.sample import Sample

HEIGHT, WIDTH, DEPTH = 0.74, 1.4, 0.7
LEG_X, LEG_Z = 0.60, 0.26


def make() -> Sample:
    """The table: front is +z."""
    top = HEIGHT - 0.018
    parts = [
        slab("top", "oak", (0, top, 0), (WIDTH, 0.036, DEPTH), radius=0.05, bevel=0.008, sides=18, rings=9),
        slab(
            "shelf",
            "oak",
            (0, 0.11, 0),
            (2 * LEG_X, 0.02, 2 * LEG_Z - 0.06),
            radius=0.02,
            bevel=0.004,
            sides=14,
            rings=6,
        ),
        _frame(top - 0.065),
        slab(
            "drawer",
            "paint",
            (0, top - 0.07, LEG_Z + 0.009),
            (0.5, 0.076, 0.03),
            radius=0.008,
            bevel=0.003,
            sides=9,
            rings=2,
        ),
        sweep(
            "drawer-handle",
            "steel",
            line((-0.06, top - 0.07, LEG_Z + 0.038), (0.06, top - 0.07, LEG_Z + 0.038), 10),
            circle(0.007, 12),
            side=(0, 1, 0),
        ),
    ]
    for x in (-0.045, 0.045):
        pin = line((x, top - 0.07, LEG_Z + 0.01), (x, top - 0.07, LEG_Z + 0.038), 3)
        parts.append(sweep("drawer-handle-" + ("left" if x > 0 else "right"), "steel", pin, circle(0.005, 10)))
    for end, z in (("front", LEG_Z), ("back", -LEG_Z)):
        for side, x in (("left", LEG_X), ("right", -LEG_X)):
            leg = line((x * 1.06, 0.03, z * 1.12), (x, HEIGHT - 0.03, z), 30)
            outline = rounded(0.07, 0.07, 0.016, sides=2)
            parts.append(sweep(f"{end}-{side}-leg", "oak", leg, outline, scale=np.linspace(0.5, 1.0, 31)))
            foot = line((x * 1.064, 0.0, z * 1.128), (x * 1.058, 0.06, z * 1.116), 4)
            parts.append(sweep(f"{end}-{side}-foot", "steel", foot, circle(0.024, 16)))
    materials = {"oak": (0.76, 0.58, 0.38), "paint": (0.25, 0.42, 0.40), "steel": (0.35, 0.36, 0.38)}
    return Sample("table", parts, materials, _control_points())


def _frame(y: float) -> Part:
    """The boards between the legs, with open sheets across: edges that three faces share."""
    boards = []
    for z in (LEG_Z, -LEG_Z):
        path = line((LEG_X, y, z), (-LEG_X, y, z), 30)
        boards.append(sweep("frame", "oak", path, rounded(0.09, 0.022, 0.004, sides=2, corner=1), side=(0, 1, 0)))
    for x in (LEG_X, -LEG_X):
        path = line((x, y, LEG_Z), (x, y, -LEG_Z), 14)
        boards.append(sweep("frame", "oak", path, rounded(0.09, 0.022, 0.004, sides=2, corner=1), side=(0, 1, 0)))
    edges = [line((0, y + dy, LEG_Z), (0, y + dy, -LEG_Z), 14) for dy in (-0.03, 0.0, 0.03)]
    boards.append(sheet("frame", "oak", np.stack(edges)))
    for dx in (-0.04, 0.04):  # a T in section: a flange on either side of the sheet's upper edge
        flange = line((dx, y + 0.03, LEG_Z), (dx, y + 0.03, -LEG_Z), 14)
        boards.append(sheet("frame", "oak", np.stack([edges[2], flange])))
    return welded("frame", "oak", boards)


def _control_points() -> ControlPoints:
    names, sources, targets = [], [], []
    for end, z in (("front", LEG_Z), ("back", -LEG_Z)):
        for side, x in (("left", LEG_X), ("right", -LEG_X)):
            outward = 0.22 * np.sign(x)
            names += [f"{end}-{side}-foot", f"top-{end}-{side}"]
            sources += [(x * 1.06, 0.0, z * 1.12), (x, HEIGHT - 0.018, z)]
            targets += [(x * 1.06 + outward, -0.22, z * 1.12), (x + outward, HEIGHT - 0.018, z)]
    names += ["shelf-middle", "top-middle", "drawer"]
    sources += [(0.0, 0.11, 0.0), (0.0, HEIGHT - 0.018, 0.0), (0.0, HEIGHT - 0.088, LEG_Z + 0.02)]
    targets += [(0.0, -0.11, 0.0), *sources[-2:]]
    return ControlPoints(np.round(sources, 4), np.round(targets, 4), names)
