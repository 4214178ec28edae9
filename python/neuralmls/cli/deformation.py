"""From a shape and control points to positions, stage by stage."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from neuralmls.advice import Advice, advise
from neuralmls.cli.session import Settings
from neuralmls.cli.stages import Stages
from neuralmls.cli.weights import WeightsChoice
from neuralmls.control_points import LARGEST, ControlPoints
from neuralmls.deformer import Deformer, Floats
from neuralmls.errors import ControlPointError, FileError
from neuralmls.exact import Aim, ExactHandles
from neuralmls.shape import Shape
from neuralmls.weights import InverseDistanceWeights, NeuralWeights, ShapeAwareWeights, softmax

# A control point with less of the weight at its own place shares it; the training aims at 0.9.
OWNED = 0.85
# An exact control point that is farther from its target than this part of the longest side has not arrived.
ARRIVED = 1e-6


@dataclass(frozen=True)
class Deformation:
    """A shape's new positions, and how far each control point ended from its target, and from its rotation in degrees.

    `off` is NaN for those that carry none; `adherence` is what was used, `kept_soft` why that is 0 where more was asked
    for. `short` is how far each is from where the adherence was to take it, and `remedy` with what it would arrive.
    """

    positions: Floats
    maps: NDArray[np.float64] | None
    weights: NeuralWeights | ShapeAwareWeights | InverseDistanceWeights
    missed: NDArray[np.float64]
    off: NDArray[np.float64]
    adherence: float
    kept_soft: str | None
    short: NDArray[np.float64]
    remedy: str | None


def check_size(shape: Shape) -> None:
    """Refuse a shape without any extent, which there is nothing to measure by.

    Raises
    ------
    FileError
        All vertices are in one place.
    """
    if not longest_side(shape) > 0:
        count = len(shape.positions)
        found = "there is only one vertex" if count == 1 else f"all {count} vertices are in one place"
        raise FileError(f"{shape.path}: {found}, so that there is no size to measure by")


def check_points(points: ControlPoints, file: Path, shape: Shape) -> list[str]:
    """Warn of control points that lie far outside of the shape.

    Raises
    ------
    ControlPointError
        They have another dimension than the shape, or are nowhere near anything; the message names both files.
    """
    try:
        return points.check(shape.bounds)
    except ControlPointError as error:
        raise ControlPointError(f"{file}, for {shape.path}: {error}") from None


def longest_side(shape: Shape) -> float:
    """The longest side of the shape's box, in file units.

    Raises
    ------
    FileError
        It is so long that squares of lengths overflow.
    """
    low, high = shape.bounds
    if (high / LARGEST - low / LARGEST).max() > 1:
        raise FileError(f"{shape.path}: the shape is more than {LARGEST:g} units long: no coordinates of a real thing")
    return float((high - low).max())


def deformed(shape: Shape, points: ControlPoints, settings: Settings, stages: Stages) -> Deformation:
    """Fit the weights, bind the shape to them, and move the control points near their targets, or onto them."""
    transform, temperature = settings.transform, settings.temperature
    with stages.stage(settings.choice.stage) as report:
        weights = settings.choice.make(points.sources, shape, report)
    with stages.stage("bind") as report:
        deformer = Deformer(shape.positions, weights, transform=transform, progress=report)
    with stages.stage("move") as report:
        rotations, scales = points.rotations, points.scales
        exact = ExactHandles(weights, transform=transform)
        aim_at = exact.aim_carefully if settings.careful else exact.aim
        aim = aim_at(points.targets, temperature, settings.adherence, rotations=rotations, scales=scales)
        aimed = aim.targets
        maps: NDArray[np.float64] | None = None
        if shape.has_normals:
            y, maps = deformer.deform(
                aimed, temperature, rotations=rotations, scales=scales, return_maps=True, progress=report
            )
        else:
            y = deformer.deform(aimed, temperature, rotations=rotations, scales=scales, progress=report)
        handles = Deformer(points.sources, weights, transform=transform)
        arrived, turned = handles.deform(aimed, temperature, rotations=rotations, scales=scales, return_maps=True)
        missed = np.linalg.norm(arrived - points.targets, axis=1)
        remedy = None
        if aim.soft is not None:
            remedy = exact.remedy(points.targets, temperature, settings.adherence, rotations=rotations, scales=scales)
    kept_soft = _why_soft(aim, remedy, points, settings)
    adherence = settings.adherence if kept_soft is None else 0.0
    return Deformation(y, maps, weights, missed, _off(turned, rotations), adherence, kept_soft, aim.misses, remedy)


def _why_soft(aim: Aim, remedy: str | None, points: ControlPoints, settings: Settings) -> str | None:
    """Why control points were left soft, and what would take them to their targets, if that is so."""
    if aim.soft is None or aim.soft.reason != "shared":
        return None
    said = f"'{points.names[aim.soft.control_point]}' has only {aim.soft.amount:.2g} of the weight at its own place"
    if remedy is not None:
        said += f"; {remedy} they arrive"
    if settings.choice.steps is not None:
        said += "; without --steps it is trained until they own their places"
    return said


def _off(maps: NDArray[np.float64], rotations: NDArray[np.float64] | None) -> NDArray[np.float64]:
    """The angle in degrees between the rotation in each map (m, d, d) and that which was asked for."""
    d = maps.shape[1]
    off = np.full(len(maps), np.nan)
    if rotations is None:
        return off
    for i in np.flatnonzero(~np.isnan(rotations[:, 0, 0])):
        u, _, vt = np.linalg.svd(maps[i] @ rotations[i].T)
        cosine = (np.trace(u @ vt) - (d - 2)) / 2
        off[i] = np.degrees(np.arccos(np.clip(cosine, -1, 1)))
    return off


def not_parted(points: ControlPoints, choice: WeightsChoice, result: Deformation) -> list[str]:
    """Warn of control points that the whole training did not part, and which then move together."""
    if not isinstance(result.weights, NeuralWeights) or choice.steps is not None:
        return []
    own = np.diagonal(softmax(result.weights.logits(points.sources)))
    names = [f"'{points.names[i]}'" for i in own.argsort() if own[i] < OWNED]
    if not names:
        return []
    listed = ", ".join(names[:5]) + (f" and {len(names) - 5} more" if len(names) > 5 else "")
    return [
        f"after {result.weights.steps:,} steps of training, control points still share their places with others, "
        f"and stop short of their targets: {listed}; they are probably too close together"
    ]


def not_arrived(points: ControlPoints, shape: Shape, result: Deformation) -> list[str]:
    """Warn of control points that were to be taken to their targets, as far as the adherence says, and are not."""
    short = [i for i in result.short.argsort()[::-1] if result.short[i] > ARRIVED * longest_side(shape)]
    if not short or result.kept_soft is not None:
        return []
    listed = ", ".join(f"'{points.names[i]}' by {result.short[i]:.3g}" for i in short[:5])
    listed += f" and {len(short) - 5} more" if len(short) > 5 else ""
    if result.remedy is not None:
        way_out = f"{result.remedy} they arrive"
    else:
        way_out = "move them less, or try a lower temperature or --transform affine"
    return [
        "control points do not arrive exactly: "
        f"{listed}; their targets contradict each other under this transform: {way_out}"
    ]


def advice(shape: Shape, points: ControlPoints, result: Deformation, settings: Settings) -> list[Advice]:
    """Return what is likely bad about the result, and what would help."""
    return advise(
        shape.positions,
        shape.faces,
        result.weights,
        points.targets,
        transform=settings.transform,
        temperature=settings.temperature,
        adherence=result.adherence,
        rotations=points.rotations,
        scales=points.scales,
        careful=settings.careful,
        names=points.names,
    )
