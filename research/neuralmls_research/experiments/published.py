"""The paper's shapes with the control points and displacements that its authors published, where the data is there."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from neuralmls import ControlPoints, Shape, read
from neuralmls.errors import FileError, NeuralMLSError


@dataclass(frozen=True)
class Published:
    """A shape, and its control points with each of the displacements.

    Attributes
    ----------
    shape : Shape
    displacements : dict
        `ControlPoints` in the coordinates of the file, by the displacement's name ("default", "user_study_1", ...).
    """

    shape: Shape
    displacements: dict[str, ControlPoints]


def published(data: Path, name: str) -> Published | None:
    """Read `data/shapenet/NAME/model.obj` and its control points; None where they are not there.

    Normalised control points are in halves of the box's longest side from its middle.

    Raises
    ------
    FileError
        They are there, but cannot be read.
    """
    table, model = data / "shapenet" / "control_points.json", data / "shapenet" / name / "model.obj"
    if not model.is_file() or not table.is_file():
        return None
    try:
        entry = json.loads(table.read_bytes())[name]
        shape = read(model)
        low, high = shape.bounds
        file = entry["space"] == "file"
        centre, half = (0.0, 1.0) if file else ((low + high) / 2, float((high - low).max()) / 2)
        sources = centre + half * np.array(entry["control_points"], dtype=np.float64)
        return Published(
            shape,
            {
                case: ControlPoints(sources, sources + half * _offsets(offsets, sources), entry["names"])
                for case, offsets in entry["offsets"].items()
            },
        )
    except (OSError, ValueError, KeyError, TypeError) as error:
        if isinstance(error, NeuralMLSError):
            raise
        raise FileError(f"{table}: expected the paper's control points, found something else: {error}") from error


def _offsets(offsets: object, sources: NDArray[np.float64]) -> NDArray[np.float64]:
    found = np.array(offsets, dtype=np.float64)
    if found.shape != sources.shape:
        raise ValueError(f"{len(sources)} control points, but offsets of shape {found.shape}")
    return found
