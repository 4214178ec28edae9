"""The deformations of the study: three categories, three shapes each, three displacements each."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

from neuralmls import ControlPoints, Shape, read
from neuralmls.errors import FileError
from neuralmls_research.baselines.kpd import KeypointDeformer
from neuralmls_research.experiments.methods import Geometry, Surface
from neuralmls_research.experiments.published import Published, published
from neuralmls_research.experiments.study.keypoint_cases import on_keypoints
from neuralmls_research.experiments.study.variants import FACING_X, VARIANTS, made

CATEGORIES = ("chair", "airplane", "car")
# The paper's shapes, as far as they were published with the displacements of its study.
PUBLISHED: dict[str, tuple[str, ...]] = {
    "chair": ("ShapeNetChair1", "ShapeNetChair3"),
    "airplane": ("ShapeNetPlane1", "ShapeNetPlane2"),
    "car": (),
}
# The paper's cars were not published with its data; these face +z.
FROM_DATA: dict[str, dict[str, str]] = {
    "chair": {},
    "airplane": {},
    "car": {
        "beetle": "VW-new-beetle/VW-new-beetle.obj",
        "smart": "smart-car/smart-car.obj",
        "sedan": "kaykit_cars/car_sedan.gltf",
    },
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
        Where the shape comes from: "published with the paper", "from the data", or "made by this package".
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


def cases(
    data: str | os.PathLike[str] | None, networks: Mapping[str, KeypointDeformer] | None = None
) -> Iterator[Case]:
    """Yield the study's 27 deformations: the published ones that `data` holds, others in the same manner for the rest.

    Parameters
    ----------
    data : path, optional
        A folder with `shapenet/control_points.json` and `shapenet/NAME/model.obj`, and `manufactured` with cars.
    networks : dict, optional
        KeypointDeformer by category. Where there is one, its keypoints are the control points, as in the paper; where
        not, the package's own shapes with theirs stand in.

    Raises
    ------
    FileError
        Shapes or control points are there, but cannot be read.
    """
    for category in CATEGORIES:
        network = (networks or {}).get(category)
        found = list(islice(_of_category(category, data, network), SHAPES))
        for name, origin, shape, displacements in found:
            for displacement, points in displacements.items():
                yield Case(category, name, displacement, origin, shape, points)


Found = tuple[str, str, Geometry, dict[str, ControlPoints]]


def _of_category(
    category: str, data: str | os.PathLike[str] | None, network: KeypointDeformer | None
) -> Iterator[Found]:
    """Shapes of a category, each with its displacements, those to be preferred first."""
    for name, (shape, displacements) in [] if data is None else _published(Path(data), PUBLISHED[category]):
        yield name, "published with the paper", shape, displacements
    if data is not None and network is not None:
        for name, file in FROM_DATA[category].items():
            path = Path(data) / "manufactured" / file
            if path.is_file():
                stored = read(path)
                surface = Surface(stored.positions @ FACING_X.T, stored.faces)
                yield name, "from the data", surface, on_keypoints(network, category, surface)
    for variant in VARIANTS[category]:
        surface, displacements = made(variant)
        own = displacements if network is None else on_keypoints(network, category, surface)
        yield variant.name, "made by this package", surface, own


def _published(data: Path, names: Iterable[str]) -> list[tuple[str, tuple[Shape, dict[str, ControlPoints]]]]:
    """The shapes of these names that are there, with the displacements of the paper's study, by number."""
    found = [(name, entry) for name in names if (entry := published(data, name)) is not None]
    return [(name, (entry.shape, _numbered(name, entry))) for name, entry in found]


def _numbered(name: str, entry: Published) -> dict[str, ControlPoints]:
    try:
        return {f"displacement {n}": entry.displacements[f"user_study_{n}"] for n in range(1, DISPLACEMENTS + 1)}
    except KeyError as missing:
        raise FileError(f"control_points.json: '{name}' has no displacement {missing}") from None
