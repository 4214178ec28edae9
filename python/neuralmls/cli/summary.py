"""The summary of a deformation: for machines a document, for people two small tables."""

from __future__ import annotations

from math import floor, log10
from typing import Any, TextIO

import numpy as np

from neuralmls.cli import console
from neuralmls.cli.deformation import Deformation, longest_side
from neuralmls.cli.session import Settings
from neuralmls.control_points import ControlPoints
from neuralmls.shape import Shape
from neuralmls.weights import InverseDistanceWeights

MOST = 20  # control points in a summary, unless all are asked for


def summary(shape: Shape, points: ControlPoints, settings: Settings, result: Deformation) -> dict[str, Any]:
    """What was done, lengths in file units. The caller adds the output and the seconds."""
    choice = settings.choice
    weights: dict[str, Any] = {"kind": choice.kind}
    function = result.weights
    if not isinstance(function, InverseDistanceWeights):
        weights |= {"loss": function.loss, "steps": function.steps, "seed": choice.seed or 0}
    else:
        weights |= {"alpha": function.alpha, "epsilon": function.epsilon}
    moved = np.linalg.norm(points.targets - points.sources, axis=1)
    told = [
        {"name": name, "moved": float(m), "distance_to_target": float(d)}
        for name, m, d in zip(points.names, moved, result.missed, strict=True)
    ]
    for one, turn, off in zip(told, points.turns, result.off, strict=True):
        if turn is not None:
            one |= {"turned": turn.degrees, "degrees_to_rotation": float(off), "scaled": turn.scale}
    return {
        "input": str(shape.path),
        "format": shape.format,
        "vertices": len(shape.positions),
        "triangles": 0 if shape.faces is None else len(shape.faces),
        "longest_side": longest_side(shape),
        "weights": weights,
        "transform": settings.transform,
        "temperature": settings.temperature,
        "adherence": result.adherence,
        "kept_soft": result.kept_soft,
        "session": settings.session,
        "control_points": told,
    }


def show(told: dict[str, Any], *, everything: bool, file: TextIO) -> None:
    """Print a summary for a person."""
    points, weights, side = told["control_points"], told["weights"], told["longest_side"]
    vertices = f"{told['vertices']:,}"
    if told["triangles"]:
        vertices += f", in {told['triangles']:,} triangles"
    count = sum(point["moved"] > 0 for point in points)
    turned = sum("turned" in point for point in points)
    console.line(f"{told['input']} -> {', '.join(told['files'] or [told['output']])}", file)
    console.pairs(
        [
            ("vertices", vertices),
            (
                "control points",
                f"{len(points):,}, {count:,} of them moved" + (f", {turned:,} turned" if turned else ""),
            ),
            ("weights", _weights(weights)),
            ("transform", f"{told['transform']}, temperature {told['temperature']:g}"),
            *_handles(told),
            ("seconds", ", ".join(f"{name} {value:.2f}" for name, value in told["seconds"].items())),
            ("", f"{sum(told['seconds'].values()):.2f} in all"),
        ],
        file,
    )
    shown = points
    if not everything and len(points) > MOST:
        shown = sorted(points, key=lambda point: ("turned" not in point, -point["distance_to_target"]))[:MOST]
    rows = [
        (
            point["name"],
            _length(point["moved"], side),
            _length(point["distance_to_target"], side),
            f"{100 * point['distance_to_target'] / side:.2f} %",
            *(_turn(point) if turned else ()),
        )
        for point in shown
    ]
    print(file=file)
    titles = ["control point", "moved by", "off its target by", "of the size"]
    titles += ["turned by", "off its rotation by"] if turned else []
    console.table(titles, rows, tuple(range(1, len(titles))), file)
    if len(shown) < len(points):
        first = "turned, then the farthest" if turned else "farthest"
        console.line(f"  the {MOST} {first} from their targets; --verbose shows all {len(points):,}", file)


def _turn(point: dict[str, Any]) -> tuple[str, str]:
    """By how much a control point is turned, and how much of that is missing."""
    if "turned" not in point:
        return "", ""
    scaled = f", scaled {point['scaled']:g}" if point["scaled"] != 1 else ""
    return f"{point['turned']:.4g} deg{scaled}", f"{point['degrees_to_rotation']:.1f} deg"


def _handles(told: dict[str, Any]) -> list[tuple[str, str]]:
    """What took the control points to their targets, or why nothing did; one thing a line."""
    adherence, kept_soft = told["adherence"], told["kept_soft"]
    named = {0.0: "soft", 1.0: "exact"}.get(adherence, f"adherence {adherence:g}")
    lines = [named] if kept_soft is None else ["left soft:", *kept_soft.split("; ")]
    if told["session"] is not None:
        lines.append(f"settings of {told['session']}")
    return list(zip(["handles", *[""] * len(lines)], lines, strict=False))


def _weights(weights: dict[str, Any]) -> str:
    if weights["kind"] != "inverse-distance":
        return f"{weights['kind']}, loss {weights['loss']:.3g} after {weights['steps']:,} steps, seed {weights['seed']}"
    return f"inverse-distance, alpha {weights['alpha']:g}, epsilon {weights['epsilon']:g}"


def _length(value: float, side: float) -> str:
    """A length in file units, to about a hundred-thousandth of the shape; what is rounding only is 0."""
    if value < 1e-7 * side:
        return "0"
    if value >= 1e9:
        return f"{value:.6g}"
    digits = max(4 - floor(log10(side)), 0)
    text = f"{value:.{digits}f}"
    return text if float(text) > 0 else f"< {10.0**-digits:.{digits}f}"
