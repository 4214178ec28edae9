"""Displacements of KeypointDeformer's own keypoints: the paper's protocol, in which all methods get these.

Its networks find the same part of every shape of a category at the same place in their output, so that a displacement
names parts, and fits every shape.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from neuralmls import ControlPoints
from neuralmls_research.baselines.kpd import KeypointDeformer
from neuralmls_research.experiments.methods import Geometry

# Which part each keypoint of the published networks is, in their order, for shapes that face +x.
PARTS: dict[str, tuple[str, ...]] = {
    "airplane": (
        "rear body", "mid left wing", "body", "mid right wing", "tip right wing", "rear wings", "tip left wing", "nose",
    ),
    "car": (
        "windscreen right", "roof left", "front sill left", "front right", "tail right", "rear left", "rear sill right",
        "front left",
    ),
}  # fmt: skip
# Offsets (x forward, y up, z right) in halves of the shape's longest side, as the paper's are.
Offsets = dict[str, tuple[float, float, float]]
DISPLACEMENTS: dict[str, dict[str, Offsets]] = {
    "airplane": {
        "swept wings, long nose": {
            "tip left wing": (-0.2, 0.0, -0.1), "tip right wing": (-0.2, 0.0, 0.1), "nose": (0.3, 0.0, 0.0),
        },
        "high tail, short nose": {"rear wings": (-0.1, 0.25, 0.0), "nose": (-0.15, 0.0, 0.0)},
        "wings forward": {
            "tip left wing": (0.3, 0.0, 0.0), "mid left wing": (0.1, 0.0, 0.0),
            "tip right wing": (0.3, 0.0, 0.0), "mid right wing": (0.1, 0.0, 0.0),
        },
    },
    "car": {
        "long front": {"front left": (0.3, 0.0, 0.0), "front right": (0.3, 0.0, 0.0)},
        "low roof": {"windscreen right": (-0.05, -0.15, 0.0), "roof left": (0.0, -0.15, 0.0)},
        "wide": {
            part: (0.0, 0.0, 0.12 if part.endswith("right") else -0.12) for part in PARTS["car"]
        },
    },
}  # fmt: skip


def on_keypoints(network: KeypointDeformer, category: str, shape: Geometry) -> dict[str, ControlPoints]:
    """Return the keypoints of a shape as control points, moved by each displacement of its category, by name.

    Raises
    ------
    NotApplicable
        The shape is not in space, or has no size.
    """
    points = ControlPoints(network.keypoints(shape), names=PARTS[category])
    half = float(np.ptp(shape.positions, axis=0).max()) / 2
    return {
        name: points.moved({part: _scaled(offset, half) for part, offset in offsets.items()})
        for name, offsets in DISPLACEMENTS[category].items()
    }


def _scaled(offset: tuple[float, float, float], half: float) -> NDArray[np.float64]:
    return half * np.array(offset)
