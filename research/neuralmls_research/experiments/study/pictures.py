"""The pictures of a question: the source with its control points and arrows, and each result, by the same camera."""

from __future__ import annotations

import base64
import io
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from neuralmls import ControlPoints
from neuralmls.figures.camera import fitted
from neuralmls.figures.palette import CLAY, SOURCE, TARGET
from neuralmls.figures.stage import Stage, pyvista_or_refuse
from neuralmls_research.experiments.methods import Geometry

Array = NDArray[np.float64]

ASPECTS = (0.9, 4 / 3)  # the least and the greatest width by height: what fits the page's frames
QUALITY = 90  # of WebP, 0 to 100
FRONT = 90.0  # degrees: shapes of the study face +x
# How far beyond source and targets the camera still follows a result, in longest sides of theirs. What flies farther is
# cut off: it must not shrink the others.
FOLLOWED = 0.3


def pictures(
    shape: Geometry,
    control_points: ControlPoints,
    results: Sequence[Array],
    *,
    height: int,
    azimuth: float,
    elevation: float,
) -> list[str]:
    """Draw the source and the results, (n, 3) each; return them as data URIs, the source first.

    Parameters
    ----------
    height : int, pixels
    azimuth, elevation : float, degrees
        Where the camera stands: turned from the shape's front (+x) to its left, risen from the ground.

    Raises
    ------
    NeuralMLSError
        PyVista is not installed, or cannot draw on this machine.
    """
    pyvista = pyvista_or_refuse()
    x, p, q = shape.positions, control_points.sources, control_points.targets
    known = np.concatenate([x, p, q])
    low, high = known.min(axis=0), known.max(axis=0)
    origin, size = (low + high) / 2, float((high - low).max())
    seen = np.concatenate([known, *(np.clip(y, low - FOLLOWED * size, high + FOLLOWED * size) for y in results)])
    camera = fitted((seen - origin) / size, azimuth=FRONT + azimuth, elevation=elevation, up="y", aspects=ASPECTS)
    faces = np.asarray(shape.faces, dtype=np.int64)
    colours = np.broadcast_to((np.array(CLAY) * 255).round().astype(np.uint8), (len(x), 3))
    size_shown = round(height * camera.aspect), height
    drawn = []
    for number, positions in enumerate([x, *results]):
        stage = Stage(pyvista, *size_shown, camera)
        stage.surface((positions - origin) / size, faces, colours)
        if number == 0:
            stage.balls((p - origin) / size, SOURCE)
            stage.arrows((p - origin) / size, (q - origin) / size, TARGET)
        drawn.append(_uri(stage.picture(), size_shown))
    return drawn


def _uri(picture: NDArray[np.uint8], size: tuple[int, int]) -> str:
    from PIL import Image

    small = Image.fromarray(picture).resize(size, Image.Resampling.LANCZOS)
    out = io.BytesIO()
    small.save(out, "WEBP", quality=QUALITY, method=6)
    return "data:image/webp;base64," + base64.b64encode(out.getvalue()).decode()
