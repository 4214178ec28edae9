"""The deformations of the study: three categories, three shapes each, three displacements each."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from neuralmls import ControlPoints, Shape
from neuralmls.errors import FileError
from neuralmls_research.experiments.methods import Geometry
from neuralmls_research.experiments.published import Published, published
from neuralmls_research.experiments.study.variants import VARIANTS, made

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
        known = [] if data is None else _published(Path(data), PUBLISHED[category])
        for name, (shape, displacements) in known:
            for displacement, points in displacements.items():
                yield Case(category, name, displacement, "published with the paper", shape, points)
        for variant in VARIANTS[category][: SHAPES - len(known)]:
            surface, displacements = made(variant)
            for displacement, points in displacements.items():
                yield Case(category, variant.name, displacement, "made by this package", surface, points)


def _published(data: Path, names: Iterable[str]) -> list[tuple[str, tuple[Shape, dict[str, ControlPoints]]]]:
    """The shapes of these names that are there, with the displacements of the paper's study, by number."""
    found = [(name, entry) for name in names if (entry := published(data, name)) is not None]
    return [(name, (entry.shape, _numbered(name, entry))) for name, entry in found]


def _numbered(name: str, entry: Published) -> dict[str, ControlPoints]:
    try:
        return {f"displacement {n}": entry.displacements[f"user_study_{n}"] for n in range(1, DISPLACEMENTS + 1)}
    except KeyError as missing:
        raise FileError(f"control_points.json: '{name}' has no displacement {missing}") from None
