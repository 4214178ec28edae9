"""A grid of inputs and settings in which the order of Table 1's armadillo may appear; they are not published.

Order: what the paper prints, neural 0.412 < ARAP 0.574 < classic MLS 0.578.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, dataclass, replace
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from neuralmls import ControlPoints, Deformer, InverseDistanceWeights, NeuralWeights, farthest_points
from neuralmls.errors import NotApplicable
from neuralmls.plugin import Transform
from neuralmls_research.experiments import methods
from neuralmls_research.experiments.reproduce.lab import Lab
from neuralmls_research.experiments.reproduce.subjects import Subject, armadillo
from neuralmls_research.metrics import curvature_change

Array = NDArray[np.float64]

# The published script names its mesh armadillo_1k; the figure's is finer.
MESHES = {"1k vertices": 1_000, "4k vertices": 4_000}
CONTROL_POINTS = ("ours, twelve", "farthest, twelve", "farthest, eight")
MOTIONS = ("all limbs", "one arm")
SIZES = (0.5, 1.0)  # of our displacement
STEPS = (48, 200)  # the published scripts' 48
NARROW = (True, False)  # the published code's width without Fourier features is an eighth of the paper's
TEMPERATURES = (0.5, 1.0, 2.0)
TRANSFORMS: tuple[Transform, ...] = ("rigid", "affine")  # those of the published code in space
MEASURES = ("mean curvature", "mean curvature, median", "Laplacian")
ONE_ARM = ("left hand", "left elbow")


@dataclass(frozen=True)
class Setting:
    """One place of the grid, and what each method measures there.

    `neural`, `classic` (alpha 0.5) and `arap` are changes of `measure`; `behind` is what part of their way neural
    weights leave the control points that move short of their targets.
    """

    mesh: str
    control_points: str
    motion: str
    size: float
    steps: int
    width: int
    temperature: float
    transform: str
    measure: str
    neural: float
    classic: float
    arap: float
    behind: float

    @property
    def as_printed(self) -> bool:
        """Whether the order is the paper's."""
        return self.neural < self.arap < self.classic


@dataclass(frozen=True)
class Input:
    """A mesh with control points and a displacement, with what ARAP makes of it."""

    mesh: str
    control_points: str
    motion: str
    size: float
    subject: Subject
    arap: dict[str, float]


def grid(lab: Lab) -> list[Setting]:
    """Measure the whole grid; nothing where the armadillo is not here."""
    return [setting for mesh in MESHES for setting in _of_mesh(lab, mesh)]


def as_numbers(settings: list[Setting]) -> list[dict[str, Any]]:
    """For machines."""
    return [asdict(setting) for setting in settings]


def _of_mesh(lab: Lab, mesh: str) -> Iterator[Setting]:
    rest = armadillo(lab, MESHES[mesh])
    if rest is None:
        return
    for control_points in CONTROL_POINTS:
        placed = _placed(rest, control_points)
        inputs = [_input(mesh, control_points, motion, size, placed) for motion, size in product(MOTIONS, SIZES)]
        usable = [found for found in inputs if found is not None]
        p, bounds = placed.points.sources, placed.bounds
        classic = InverseDistanceWeights(p, alpha=0.5)
        for transform in TRANSFORMS:
            by_distance = Deformer(placed.positions, classic, transform=transform)
            others = [_measures(found.subject, by_distance.deform(found.subject.points.targets)) for found in usable]
            for steps, narrow in product(STEPS, NARROW):
                width = lab.width // 8 if narrow else lab.width
                network = NeuralWeights.fit(p, bounds=bounds, width=width, steps=steps, seed=lab.seeds[0])
                deformer = Deformer(placed.positions, network, transform=transform)
                at_points = Deformer(p, network, transform=transform)
                for temperature, (found, other) in product(TEMPERATURES, zip(usable, others, strict=True)):
                    q = found.subject.points.targets
                    values = _measures(found.subject, deformer.deform(q, temperature))
                    asked = np.linalg.norm(q - p, axis=1)
                    missed = np.linalg.norm(at_points.deform(q, temperature) - q, axis=1)
                    behind = float((missed[asked > 0] / asked[asked > 0]).mean())
                    for measure in MEASURES:
                        yield Setting(
                            mesh,
                            control_points,
                            found.motion,
                            found.size,
                            steps,
                            width,
                            temperature,
                            transform,
                            measure,
                            neural=values[measure],
                            classic=other[measure],
                            arap=found.arap[measure],
                            behind=behind,
                        )


def _placed(rest: Subject, control_points: str) -> Subject:
    """The mesh with other control points, each to be moved as the nearest of ours is."""
    if control_points == CONTROL_POINTS[0]:
        return rest
    count = 8 if control_points.endswith("eight") else 12
    p = farthest_points(rest.positions, rest.faces, count)
    nearest = np.linalg.norm(p[:, None] - rest.points.sources, axis=2).argmin(axis=1)
    offsets = (rest.points.targets - rest.points.sources)[nearest]
    assert rest.points.names is not None
    names = [f"{rest.points.names[i]} {number}" for number, i in enumerate(nearest)]
    return replace(rest, points=ControlPoints(p, p + offsets, names))


def _input(mesh: str, control_points: str, motion: str, size: float, placed: Subject) -> Input | None:
    """The input with its displacement; None where nothing moves, or where ARAP cannot do it."""
    assert placed.points.names is not None
    offsets = (placed.points.targets - placed.points.sources) * size
    if motion == MOTIONS[1]:
        offsets[[not name.startswith(ONE_ARM) for name in placed.points.names]] = 0.0
    subject = placed.moved(offsets)
    if not offsets.any():
        return None
    try:
        y = methods.METHODS["arap"](subject, subject.points.sources, subject.points.targets)
    except NotApplicable:
        return None
    return Input(mesh, control_points, motion, size, subject, _measures(subject, y))


def _measures(subject: Subject, y: Any) -> dict[str, float]:
    curvature, laplacian = curvature_change(subject.positions, np.asarray(y, dtype=np.float64), subject.faces)
    return dict(zip(MEASURES, (curvature.mean, curvature.median, laplacian.mean), strict=True))
