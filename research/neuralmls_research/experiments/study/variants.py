"""Shapes of the study that the package makes itself: samples in three proportions, with three displacements each."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from neuralmls import ControlPoints
from neuralmls.samples import make
from neuralmls.samples.parts import rotation
from neuralmls_research.experiments.methods import Surface

Array = NDArray[np.float64]
Knots = tuple[tuple[float, float], ...]

# Samples face +z. The paper's shapes face +x, and KeypointDeformer knows shapes that do.
FACING_X = rotation("y", 90.0)


@dataclass(frozen=True)
class Variant:
    """A sample in other proportions.

    Attributes
    ----------
    name : str
    sample : str
        What it is made of: "chair", "airplane" or "car".
    knots : dict
        For a coordinate (0, 1, 2: x, y, z), where some of its values go, in metres; linear in between. Only what lies
        between wheels or legs is stretched, so that these keep their form.
    """

    name: str
    sample: str
    knots: dict[int, Knots] = field(default_factory=dict)


VARIANTS = {
    "chair": (
        Variant("dining chair", "chair"),
        Variant("high chair", "chair", {1: ((-1, -1), (0, 0), (0.4, 0.62), (2, 2.22))}),
        Variant(
            "wide chair",
            "chair",
            {
                0: ((-1, -1.17), (-0.17, -0.34), (0.17, 0.34), (1, 1.17)),
                1: ((-1, -1), (0, 0), (0.4, 0.32), (0.5, 0.42), (1, 0.8), (2, 1.8)),
            },
        ),
    ),
    "airplane": (
        Variant("airliner", "airplane"),
        Variant("long airliner", "airplane", {2: ((-20, -24), (-7, -11), (-3.6, -3.6), (4.6, 4.6), (7, 11), (20, 24))}),
        Variant(
            "short airliner",
            "airplane",
            {
                0: ((-20, -25), (-11, -16), (-4.8, -4.8), (4.8, 4.8), (11, 16), (20, 25)),
                2: ((-20, -18), (-7, -5), (-3.6, -3.6), (4.6, 4.6), (7, 5.6), (20, 18.6)),
            },
        ),
    ),
    "car": (
        Variant("hatchback", "car"),
        Variant("limousine", "car", {2: ((-3, -3.45), (-0.85, -1.3), (0.8, 1.25), (3, 3.45))}),
        Variant("van", "car", {1: ((-1, -1), (0, 0), (0.74, 0.74), (1.3, 1.72), (2, 2.42))}),
    ),
}

# Offsets of control points (x, y, z as in the sample) in halves of the shape's longest side, as the paper's are.
# "left" and "right" are both meant by "side", the right one mirrored.
Offsets = dict[str, tuple[float, float, float]]
DISPLACEMENTS: dict[str, dict[str, Offsets]] = {
    "chair": {
        "longer legs, apart": {
            "front-side-foot": (0.0, -0.2, 0.2),
            "back-side-foot": (0.0, -0.2, 0.0),
        },
        "deeper seat": {
            "front-side-foot": (0.0, 0.0, 0.4),
            "seat-front-side": (0.0, 0.0, 0.4),
            "armrest-side": (0.0, 0.0, 0.25),
        },
        "short legs, leaning back": {
            "front-side-foot": (0.0, 0.2, 0.0),
            "back-side-foot": (0.0, 0.2, 0.0),
            "back-top-side": (0.0, -0.15, -0.3),
        },
    },
    "airplane": {
        "swept wings, long nose": {"side-wing-tip": (0.2, 0.0, -0.2), "nose": (0.0, 0.0, 0.4)},
        "wings forward, high fin": {
            "side-wing-tip": (0.0, 0.0, 0.2),
            "side-engine": (0.0, 0.0, 0.2),
            "fin-tip": (0.0, 0.3, 0.0),
            "nose": (0.0, 0.0, -0.1),
        },
        "wings far forward": {"side-wing-tip": (0.0, 0.0, 0.4), "side-engine": (0.0, 0.0, 0.3)},
    },
    "car": {
        "long bonnet": {
            "front-bumper": (0.0, 0.0, 0.3),
            "front-side-wheel": (0.0, 0.0, 0.3),
            "bonnet": (0.0, 0.0, 0.2),
        },
        "low roof": {
            "roof-front": (0.0, -0.12, -0.1),
            "roof-back": (0.0, -0.14, -0.2),
            "side-mirror": (0.0, -0.04, 0.0),
        },
        "wide": {
            "front-side-wheel": (0.15, 0.0, 0.0),
            "back-side-wheel": (0.15, 0.0, 0.0),
            "side-sill": (0.15, 0.0, 0.0),
            "side-mirror": (0.15, 0.0, 0.0),
        },
    },
}


def made(variant: Variant) -> tuple[Surface, dict[str, ControlPoints]]:
    """Make a variant; return its surface, and its control points moved by each displacement, by name."""
    sample = make(variant.sample)
    surface = Surface(_stretched(sample.vertices, variant.knots) @ FACING_X.T, sample.triangles)
    sources = _stretched(sample.control_points.sources, variant.knots) @ FACING_X.T
    points = ControlPoints(sources, names=sample.control_points.names)
    half = float(np.ptp(surface.positions, axis=0).max()) / 2
    return surface, {
        name: points.moved({control: half * FACING_X @ offset for control, offset in _both_sides(offsets).items()})
        for name, offsets in DISPLACEMENTS[variant.sample].items()
    }


def _stretched(points: Array, knots: dict[int, Knots]) -> Array:
    out = points.copy()
    for axis, pairs in knots.items():
        at, to = np.array(pairs, dtype=np.float64).T
        out[:, axis] = np.interp(points[:, axis], at, to)
    return out


def _both_sides(offsets: Offsets) -> dict[str, Array]:
    both = {}
    for name, (x, y, z) in offsets.items():
        both[name.replace("side", "left")] = np.array([x, y, z])
        both[name.replace("side", "right")] = np.array([-x if "side" in name else x, y, z])
    return both
