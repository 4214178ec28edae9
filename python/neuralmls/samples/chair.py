"""The sample chair: a slatted dining chair with armrests and a cushion; its moved control points make it a bar
stool with longer legs and a back that leans."""

from __future__ import annotations

import numpy as np

from neuralmls.control_points import ControlPoints
from neuralmls.samples.parts import Part, circle, curve, line, rotation, rounded, sheet, slab, sweep, welded
from neuralmls.samples.sample import Sample

SEAT = 0.44  # height of the seat board's middle
WIDTH, DEPTH = 0.46, 0.44
LEG_X, FRONT, BACK = 0.19, 0.18, -0.19
TOP = 0.98
LEAN = -16.0  # degrees that the back is leaned by


def make() -> Sample:
    """The chair: front is +z."""
    parts = [
        slab("seat", "wood", (0, SEAT, 0), (WIDTH, 0.035, DEPTH), radius=0.04, bevel=0.006, sides=10, rings=7),
        slab(
            "cushion",
            "fabric",
            (0, SEAT + 0.035, 0.015),
            (0.40, 0.045, 0.36),
            radius=0.06,
            bevel=0.02,
            arc=4,
            sides=9,
            rings=7,
        ),
        _apron(),
        _brace(),
    ]
    for x, side in ((LEG_X, "left"), (-LEG_X, "right")):
        foot, top = (x * 1.1, 0.0, FRONT * 1.12), (x, SEAT, FRONT)
        taper = np.linspace(0.72, 1.0, 37)
        parts.append(
            sweep(
                f"front-{side}-leg",
                "wood",
                line(foot, top, 36),
                rounded(0.042, 0.042, 0.009, sides=2, corner=2),
                scale=taper,
            )
        )
        path = np.concatenate([line((x * 1.1, 0, BACK * 1.2), (x, SEAT, BACK), 34)[:-1], _post(x)])
        taper = np.interp(np.arange(len(path)), [0, 34, len(path) - 1], [0.72, 1.0, 0.7])
        parts.append(
            sweep(f"back-{side}-post", "wood", path, rounded(0.042, 0.042, 0.009, sides=2, corner=2), scale=taper)
        )
        rest = curve(
            [
                (x * 1.13, 0.68, BACK - 0.02),
                (x * 1.2, 0.69, 0.0),
                (x * 1.2, 0.70, 0.12),
                (x * 1.15, 0.67, 0.19),
            ],
            24,
        )
        parts.append(sweep(f"{side}-armrest", "wood", rest, rounded(0.05, 0.024, 0.011, sides=2)))
        stay = line((x * 1.08, SEAT, 0.13), (x * 1.17, 0.68, 0.14), 18)
        parts.append(sweep(f"{side}-armrest-stay", "wood", stay, circle(0.013, 12)))
        rail = line((x * 1.07, 0.12, BACK * 1.14), (x * 1.07, 0.12, FRONT * 1.09), 22)
        parts.append(sweep(f"{side}-stretcher", "wood", rail, circle(0.011, 10)))
    for k, height in enumerate((0.60, 0.70, 0.80)):
        parts.append(_slat(f"slat-{k + 1}", height, 0.032, 0.014))
    parts.append(_slat("top-rail", 0.925, 0.085, 0.022))
    materials = {"wood": (0.62, 0.40, 0.22), "fabric": (0.22, 0.36, 0.46), "steel": (0.55, 0.56, 0.58)}
    return Sample("chair", parts, materials, _control_points())


def _back_z(height: float) -> float:
    """The middle line of the back's posts."""
    t = (height - SEAT) / (TOP - SEAT)
    return BACK - 0.03 * t - 0.05 * t * t


def _post(x: float) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    heights = np.linspace(SEAT, TOP, 36)
    return np.array([(x, height, _back_z(height)) for height in heights])


def _slat(name: str, height: float, tall: float, thick: float) -> Part:
    z = _back_z(height)
    path = curve([(LEG_X, height, z), (0.07, height, z - 0.045), (-0.07, height, z - 0.045), (-LEG_X, height, z)], 26)
    outline = rounded(tall, thick, thick * 0.4, sides=3, corner=2)
    return sweep(name, "wood", path, outline, side=(0, 1, 0))


def _apron() -> Part:
    """Four boards below the seat, joined to one."""
    y = SEAT - 0.045
    boards = []
    for start, end in (
        ((LEG_X, y, FRONT), (-LEG_X, y, FRONT)),
        ((LEG_X, y, BACK), (-LEG_X, y, BACK)),
        ((LEG_X, y, BACK), (LEG_X, y, FRONT)),
        ((-LEG_X, y, BACK), (-LEG_X, y, FRONT)),
    ):
        boards.append(
            sweep("apron", "wood", line(start, end, 16), rounded(0.06, 0.018, 0.003, sides=2, corner=1), side=(0, 1, 0))
        )
    return welded("apron", "wood", boards)


def _brace() -> Part:
    """Crossed steel sheets below the seat: open, and four faces share each edge of the middle line."""
    flights = []
    for x, z in ((LEG_X, FRONT), (LEG_X, BACK), (-LEG_X, FRONT), (-LEG_X, BACK)):
        edge = line((0, SEAT - 0.02, 0), (x, SEAT - 0.02, z), 10)
        flights.append(sheet("brace", "steel", np.stack([edge, edge - [0, 0.018, 0], edge - [0, 0.036, 0]])))
    return welded("brace", "steel", flights)


def _control_points() -> ControlPoints:
    lengthen = np.array([0.0, -0.4 * SEAT, 0.0])
    hinge = np.array([0.0, SEAT, BACK])
    lean = rotation("x", LEAN)
    rest, moved = {}, {}
    for side, sign in (("left", 1.0), ("right", -1.0)):
        x = sign * LEG_X
        rest[f"front-{side}-foot"] = np.array([x * 1.1, 0.0, FRONT * 1.12])
        rest[f"back-{side}-foot"] = np.array([x * 1.1, 0.0, BACK * 1.2])
        for end in ("front", "back"):
            moved[f"{end}-{side}-foot"] = rest[f"{end}-{side}-foot"] + lengthen
        rest[f"seat-front-{side}"] = np.array([x, SEAT, FRONT])
        rest[f"seat-back-{side}"] = np.array([x, SEAT, BACK])
        rest[f"back-top-{side}"] = np.array([x, TOP, _back_z(TOP)])
        rest[f"armrest-{side}"] = np.array([x * 1.17, 0.68, 0.14])
        moved[f"armrest-{side}"] = rest[f"armrest-{side}"] - [0.0, 0.0, 0.035]
        top = rest[f"back-top-{side}"]
        moved[f"back-top-{side}"] = hinge + lean @ (top - hinge)
    sources = [rest[name] for name in rest]
    targets = [moved.get(name, rest[name]) for name in rest]
    return ControlPoints(np.round(sources, 4), np.round(targets, 4), tuple(rest))
