"""`neuralmls inspect`: what is in a file, and what a deformation does with it."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from neuralmls.cli import console, options

if TYPE_CHECKING:
    from neuralmls.placement import MirrorPlane


@click.command()
@options.shape
@options.json
def inspect(*, shape: Path, json: bool) -> None:
    """Show what is in a file, and what a deformation will carry over."""
    from neuralmls.cli.inputs import longest_side
    from neuralmls.shape import read
    from neuralmls.symmetries import symmetry

    source = read(shape)
    longest_side(source)  # refuses what has no size that a number could hold
    low, high = source.bounds.tolist()
    beside = source.look_beside()
    planes = symmetry(source)
    size = [b - a for a, b in zip(low, high, strict=True)]
    told: dict[str, Any] = {
        "file": str(shape),
        "bytes": shape.stat().st_size,
        "format": source.format,
        "vertices": len(source.positions),
        "dimension": source.positions.shape[1],
        "triangles": 0 if source.faces is None else len(source.faces),
        "bounds": [low, high],
        "size": size,
        "symmetry": [_plane(plane) for plane in planes],
        "holds": dict(source.facts),
        "turns_normals": source.has_normals,
        "missing": beside.missing,
        "leads_out": beside.refused,
    }
    if json:
        console.document(told)
        return
    console.line(f"{shape}: {source.format}, {told['bytes']:,} bytes", sys.stdout)
    rows = [("vertices", f"{told['vertices']}")]
    if told["triangles"] and "faces" not in told["holds"]:
        rows.append(("faces", f"{told['triangles']} triangles"))
    rows += [("box", f"{_place(low)} to {_place(high)}"), ("size", " x ".join(f"{length:.6g}" for length in size))]
    rows += [("symmetry", _said(planes, max(size)))] if planes else []
    rows += source.facts
    rows += [("files that are missing", ", ".join(beside.missing))] if beside.missing else []
    rows += [("files left behind", f"{', '.join(beside.refused)} (out of its folder)")] if beside.refused else []
    console.pairs(rows, sys.stdout)
    turned = "; its normals and tangents turn with the surface" if source.has_normals else ""
    print(f"A deformation moves the positions{turned}.\nEverything else is carried over as it is.")


def _plane(plane: MirrorPlane) -> dict[str, Any]:
    return {
        "normal": plane.normal.tolist(),
        "offset": plane.offset,
        "score": plane.score,
        "matched": plane.matched,
        "verdict": plane.verdict,
    }


def _said(planes: list[MirrorPlane], side: float) -> str:
    """By how many planes the shape is symmetric, or how nearly by the best."""
    best = planes[0]
    step = side / 1000  # as exact as planes are found
    normal, offset = best.normal.round(3) + 0.0, round(best.offset / step) * step
    across = f"the plane across {_place(normal.tolist())} at {offset:.4g}"
    exact = sum(plane.verdict == "symmetric" for plane in planes)
    if exact:
        return f"by {across}" + (f", and {exact - 1} more" if exact > 1 else "")
    if best.verdict == "nearly":
        return f"nearly, by {across}: {100 * best.matched:.0f} % of it"
    return "none"


def _place(point: list[float]) -> str:
    return "(" + ", ".join(f"{value:.6g}" for value in point) + ")"
