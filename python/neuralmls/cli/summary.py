"""The summary of a deformation: for machines a document, for people two small tables."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from math import floor, log10
from pathlib import Path
from textwrap import wrap
from typing import Any, TextIO

from neuralmls.cli import console
from neuralmls.cli.inputs import longest_side
from neuralmls.report import Advice, Report
from neuralmls.session import Map
from neuralmls.shape import Shape
from neuralmls.weights import NetworkWeights

MOST = 20  # control points in a summary, unless all are asked for


def summary(
    shape: Shape,
    output: Path,
    map: Map,
    report: Report,
    advice: Sequence[Advice] | None,
    files: list[str],
    kept: list[str],
) -> dict[str, Any]:
    """What was done, lengths in file units, `side` what they are measured by. The caller adds the seconds."""
    session = map.session
    weights: dict[str, Any] = dict(session.settings["weights"])
    if isinstance(map.weights, NetworkWeights):
        weights |= {"loss": map.weights.loss, "steps": map.weights.steps}
    told = []
    for i, name in enumerate(report.names):
        moved, distance = float(report.moved[i]), float(report.distance_to_target[i])
        one: dict[str, Any] = {"name": name, "moved": moved, "distance_to_target": distance}
        orientation = report.orientations[i]
        if orientation is not None:
            one |= dict(zip(("oriented", "degrees_to_rotation", "scaled"), orientation, strict=True))
        told.append(one)
    document: dict[str, Any] = {
        "input": str(shape.path),
        "output": str(output),
        "files": files,
        "format": shape.format,
        "vertices": len(shape.positions),
        "triangles": 0 if shape.faces is None else len(shape.faces),
        "longest_side": longest_side(shape),
        "side": map.side,
        "weights": weights,
        "transform": session.settings["transform"],
        "temperature": session.settings["temperature"],
        "handles": session.settings["handles"],
        "relax": session.settings["relax"],
        "no_folds": session.settings["no_folds"],
        "steps": report.steps,
        "least": report.least,
        "folded": report.folded,
        "arrival": report.handles,
        "soft": report.soft,
        "control_points": told,
        "warnings": [*report.warnings, *kept],
    }
    if advice is not None:
        # Of handles that do not arrive it is told once.
        short = any(one.kind == "misses" for one in advice)
        arrival = [sentence for sentence in report.warnings if not (short and sentence == report.not_arrived)]
        document["advice"] = [asdict(one) for one in advice]
        document["warnings"] = [*arrival, *(one.sentence for one in advice), *kept]
    return document


def show(told: dict[str, Any], *, everything: bool, file: TextIO) -> None:
    """Print a summary for a person."""
    points, weights, side = told["control_points"], told["weights"], told["side"]
    vertices = f"{told['vertices']:,}"
    if told["triangles"]:
        vertices += f", in {told['triangles']:,} triangles"
    count = sum(point["moved"] > 0 for point in points)
    oriented = sum("oriented" in point for point in points)
    console.line(f"{told['input']} -> {', '.join(told['files'] or [told['output']])}", file)
    console.pairs(
        [
            ("vertices", vertices),
            (
                "control points",
                f"{len(points):,}, {count:,} of them moved" + (f", {oriented:,} turned" if oriented else ""),
            ),
            ("weights", _weights(weights)),
            ("transform", f"{told['transform']}, temperature {told['temperature']:g}" + _relax(told["relax"])),
            *_steps(told),
            *_handles(told),
            ("seconds", ", ".join(f"{name} {value:.2f}" for name, value in told["seconds"].items())),
            ("", f"{sum(told['seconds'].values()):.2f} in all"),
        ],
        file,
    )
    shown = points
    if not everything and len(points) > MOST:
        shown = sorted(points, key=lambda point: ("oriented" not in point, -point["distance_to_target"]))[:MOST]
    rows = [
        (
            point["name"],
            _length(point["moved"], side),
            _length(point["distance_to_target"], side),
            f"{100 * point['distance_to_target'] / side:.2f} %",
            *(_orientation(point) if oriented else ()),
        )
        for point in shown
    ]
    print(file=file)
    titles = ["control point", "moved by", "off its target by", "of the size"]
    titles += ["turned by", "off its rotation by"] if oriented else []
    console.table(titles, rows, tuple(range(1, len(titles))), file)
    if len(shown) < len(points):
        first = "turned, then the farthest" if oriented else "farthest"
        console.line(f"  the {MOST} {first} from their targets; --verbose shows all {len(points):,}", file)


def _orientation(point: dict[str, Any]) -> tuple[str, str]:
    """By how much a control point is turned, and how much of that is missing."""
    if "oriented" not in point:
        return "", ""
    scaled = f", scaled {point['scaled']:g}" if point["scaled"] != 1 else ""
    return f"{point['oriented']:.4g} deg{scaled}", f"{point['degrees_to_rotation']:.1f} deg"


def _handles(told: dict[str, Any]) -> list[tuple[str, str]]:
    """What took the control points to their targets, or why nothing did; one thing a line."""
    soft = told["soft"]
    lines = [told["arrival"]] if soft is None else ["left soft:", *soft.split("; ")]
    lines = [part for line in lines for part in wrap(line, 60)]
    if told["session"] is not None:
        lines.append(f"settings of {told['session']}")
    return list(zip(["handles", *[""] * len(lines)], lines, strict=False))


def _steps(told: dict[str, Any]) -> list[tuple[str, str]]:
    """In how many steps nothing folds, and how much room the narrowest place keeps."""
    if not told["no_folds"]:
        return []
    count = told["steps"]
    return [("no folds", f"{count} step{'s' if count > 1 else ''}, least det J {told['least']:.2g}")]


def _relax(relax: float) -> str:
    return f", relax {relax:g}" if relax else ""


def _weights(weights: dict[str, Any]) -> str:
    if weights["kind"] != "inverse-distance":
        how = f"after {weights['steps']:,} steps" if weights["steps"] else "in closed form"
        return f"{weights['kind']}, loss {weights['loss']:.3g} {how}, seed {weights['seed']}"
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
