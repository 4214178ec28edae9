"""The deformations of the study: three categories, three shapes each, three displacements each."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from neuralmls.control_points import ControlPoints
from neuralmls.errors import FileError, NeuralMLSError
from neuralmls.experiments.methods import Geometry
from neuralmls.experiments.study.variants import VARIANTS, made
from neuralmls.shape import Shape, read

CATEGORIES = ("chair", "airplane", "car")
# The paper's shapes, as far as they were published with the displacements of its study.
PUBLISHED: dict[str, tuple[str, ...]] = {
    "chair": ("ShapeNetChair1", "ShapeNetChair3"),
    "airplane": ("ShapeNetPlane1", "ShapeNetPlane2"),
    "car": (),
}
SHAPES = 3  # of each category
DISPLACEMENTS = 3  # of each shape
COUNT = len(CATEGORIES) * SHAPES * DISPLACEMENTS


@dataclass(frozen=True)
class Case:
    """One deformation to judge.

    Attributes
    ----------
    category, name, displacement : str
    origin : str
        Where the shape comes from: "published with the paper", or "made by this package".
    shape : Shape or Surface
        It faces +x, y is up.
    control_points : ControlPoints
    """

    category: str
    name: str
    displacement: str
    origin: str
    shape: Geometry
    control_points: ControlPoints


def cases(data: str | os.PathLike[str] | None) -> Iterator[Case]:
    """Yield the study's 27 deformations: the published ones that `data` holds, the package's own for the others.

    Parameters
    ----------
    data : path, optional
        A folder with `shapenet/control_points.json` and `shapenet/NAME/model.obj`.

    Raises
    ------
    FileError
        Shapes or control points are there, but cannot be read.
    """
    for category in CATEGORIES:
        published = [] if data is None else _published(Path(data) / "shapenet", PUBLISHED[category])
        for name, (shape, displacements) in published:
            for displacement, points in displacements.items():
                yield Case(category, name, displacement, "published with the paper", shape, points)
        for variant in VARIANTS[category][: SHAPES - len(published)]:
            surface, displacements = made(variant)
            for displacement, points in displacements.items():
                yield Case(category, variant.name, displacement, "made by this package", surface, points)


def _published(folder: Path, names: Iterable[str]) -> list[tuple[str, tuple[Shape, dict[str, ControlPoints]]]]:
    """The shapes of these names that are there, with the displacements of the paper's study, by number."""
    table = folder / "control_points.json"
    found = [name for name in names if (folder / name / "model.obj").is_file()]
    if not found or not table.is_file():
        return []
    try:
        entries = json.loads(table.read_bytes())
        return [(name, _moved(read(folder / name / "model.obj"), entries[name])) for name in found]
    except (OSError, ValueError, KeyError, TypeError) as error:
        if isinstance(error, NeuralMLSError):
            raise
        raise FileError(f"{table}: expected the paper's control points, found something else: {error}") from error


def _moved(shape: Shape, entry: dict[str, Any]) -> tuple[Shape, dict[str, ControlPoints]]:
    """A published shape, whose control points and offsets are in halves of its longest side from its middle."""
    low, high = shape.bounds
    half = (high - low).max() / 2
    sources = (low + high) / 2 + half * np.array(entry["control_points"], dtype=np.float64)
    return shape, {
        f"displacement {number}": ControlPoints(
            sources, sources + half * np.array(entry["offsets"][f"user_study_{number}"]), entry["names"]
        )
        for number in range(1, DISPLACEMENTS + 1)
    }
