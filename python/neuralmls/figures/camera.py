"""Where the camera of a figure stands: one for all panels, close enough that everything just fits."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

VIEW_ANGLE = 24.0  # degrees from the bottom of a picture to its top; narrow, so that long parts stay in proportion
MARGIN = 1.06


@dataclass(frozen=True)
class Camera:
    """A perspective camera, and how wide what it sees is for its height."""

    position: Array
    focus: Array
    up: Array
    aspect: float


def fitted(points: Array, *, azimuth: float, elevation: float, up: str, aspects: tuple[float, float]) -> Camera:
    """The nearest camera that looks from a direction and has all points, (n, 3), in its picture.

    `azimuth` turns from the front to the shape's left, `elevation` rises from the ground, both in degrees. The
    front is +z where y is up and -y where z is up. The aspect is the one that the points fill, but not outside of
    `aspects`, the least and the greatest.
    """
    a, e = np.radians(azimuth), np.radians(np.clip(elevation, -89.9, 89.9))
    toward = np.array([np.sin(a) * np.cos(e), np.sin(e), np.cos(a) * np.cos(e)])
    upward = np.array([0.0, 1.0, 0.0])
    if up == "z":
        toward, upward = toward[[0, 2, 1]] * [1, -1, 1], np.array([0.0, 0.0, 1.0])
    right = np.cross(upward, toward)
    right /= np.linalg.norm(right)
    screen_up = np.cross(toward, right)

    middle = (points.min(axis=0) + points.max(axis=0)) / 2
    x, y, z = ((points - middle) @ axis for axis in (right, screen_up, toward))
    aspect = float(np.clip(np.ptp(x) / max(float(np.ptp(y)), 1e-12), *aspects))
    tangent_y = np.tan(np.radians(VIEW_ANGLE) / 2) / MARGIN
    tangent_x = tangent_y * aspect
    centre_x = centre_y = distance = 0.0
    for _ in range(20):  # what is near looks larger, so the middle of the picture depends on the distance
        distance = float(
            max((np.abs(x - centre_x) / tangent_x + z).max(), (np.abs(y - centre_y) / tangent_y + z).max())
        )
        distance = max(distance, 1e-3)  # all points at one place
        depth = np.maximum(distance - z, 1e-9)
        seen_x, seen_y = (x - centre_x) / depth, (y - centre_y) / depth
        centre_x += (seen_x.max() + seen_x.min()) / 2 * distance * 0.7
        centre_y += (seen_y.max() + seen_y.min()) / 2 * distance * 0.7
    focus = middle + centre_x * right + centre_y * screen_up
    return Camera(focus + distance * toward, focus, upward, aspect)
