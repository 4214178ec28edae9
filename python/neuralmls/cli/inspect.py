"""`neuralmls inspect`: what is in a file, and what a deformation does with it."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import click

from neuralmls.cli import console, options


@click.command()
@options.shape
@options.json
def inspect(*, shape: Path, json: bool) -> None:
    """Show what is in a file, and what a deformation will carry over."""
    from neuralmls.cli.inputs import longest_side
    from neuralmls.shape import read

    source = read(shape)
    longest_side(source)  # refuses what has no size that a number could hold
    low, high = source.bounds.tolist()
    beside = source.look_beside()
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
    rows += source.facts
    rows += [("files that are missing", ", ".join(beside.missing))] if beside.missing else []
    rows += [("files left behind", f"{', '.join(beside.refused)} (out of its folder)")] if beside.refused else []
    console.pairs(rows, sys.stdout)
    turned = "; its normals and tangents turn with the surface" if source.has_normals else ""
    print(f"A deformation moves the positions{turned}.\nEverything else is carried over as it is.")


def _place(point: list[float]) -> str:
    return "(" + ", ".join(f"{value:.6g}" for value in point) + ")"
