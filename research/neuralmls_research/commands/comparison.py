"""What a comparison says: a document and a CSV file for machines, two tables and a scatter for people."""

from __future__ import annotations

import csv
import io
from dataclasses import asdict
from pathlib import Path
from typing import Any, TextIO

from neuralmls import Shape
from neuralmls.cli.plugin import console
from neuralmls.plugin import write_atomically
from neuralmls_research.experiments.compare import Result
from neuralmls_research.experiments.methods import OURS


def document(shape: Shape, results: dict[str, Result]) -> dict[str, Any]:
    """Everything that was measured; lengths in halves of the longest side of the shape's box."""
    methods = []
    for name, result in results.items():
        measures = None if result.measures is None else _known(asdict(result.measures))
        methods.append(
            {
                "name": name,
                "title": result.title,
                "seconds": result.seconds,
                "not_applicable": result.reason,
                "measures": measures,
            }
        )
    count = 0 if shape.faces is None else len(shape.faces)
    return {"vertices": len(shape.positions), "triangles": count, "methods": methods}


def write_csv(path: Path, methods: list[dict[str, Any]]) -> None:
    """Write a row a method and a column a figure, empty where there is none."""
    rows = [_flat({**method, **(method["measures"] or {}), "measures": {}}) for method in methods]
    names = dict.fromkeys(name for row in rows for name in row)
    out = io.StringIO()
    writer = csv.DictWriter(out, list(names), lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    write_atomically(path, out.getvalue().encode())


def draw_scatter(path: Path, results: dict[str, Result]) -> None:
    """Draw each method's distortion against its control-point error."""
    from neuralmls_research.scatter import scatter

    points = {
        result.title: [(100 * result.measures.at_vertices / 2, result.measures.curvature.mean)]
        for result in results.values()
        if result.measures is not None and result.measures.curvature is not None
    }
    scatter(
        points,
        path,
        x_label="control points off their targets, mean, % of the shape's longest side",
        y_label="change of mean curvature, mean, the shape in [-1, 1]",
    )


def show(told: dict[str, Any], file: TextIO) -> None:
    """Print the tables, what was left out, and why methods do not apply."""
    done = [method for method in told["methods"] if method["measures"] is not None]
    vertices, triangles = f"{told['vertices']:,}", f"{told['triangles']:,}"
    console.line(f"{told['input']}: {vertices} vertices, {triangles} triangles", file)
    rows = [
        (
            method["title"],
            _percent(method["measures"]["at_vertices"] / 2),
            _percent(_half(method["measures"]["at_points"])),
            _number(method["measures"]["folded"], ","),
            f"{method['seconds']:.2f}",
        )
        for method in done
    ]
    head = ["method", "off targets, nearest vertex", "at the point", "vertices folded", "seconds"]
    console.table(head, rows, (1, 2, 3, 4), file)
    surfaces = [method for method in done if method["measures"]["strain"] is not None]
    if surfaces:
        print(file=file)
        head = ["distortion", "curvature", "median", "Laplacian", "Dirichlet", "median", "area", "edges", "volume"]
        console.table([*head, "flipped"], [_distortion(method) for method in surfaces], range(1, 10), file)
        for sentence in _left_out(surfaces[0]["measures"], told):
            console.line(f"  {sentence}", file)
    if any(OURS in method["title"] for method in done):
        console.line(f"{OURS}: not in the paper", file)
    reasons = [(m["title"], m["not_applicable"]) for m in told["methods"] if m["not_applicable"] is not None]
    if reasons:
        print("\nwhat does not apply", file=file)
        console.pairs(reasons, file)
    for name in told["files"]:
        console.line(f"  wrote {name}", file)


def _distortion(method: dict[str, Any]) -> tuple[str, ...]:
    measures = method["measures"]
    strain = measures["strain"]
    return (
        method["title"],
        _number(measures["curvature"]["mean"], ".4g"),
        _number(measures["curvature"]["median"], ".4g"),
        _number(measures["laplacian"]["mean"], ".3g"),
        _number(strain["dirichlet_mean"], ".4g"),
        _number(strain["dirichlet_median"], ".4g"),
        _percent(strain["area_mean"]),
        _percent(strain["edge_mean"]),
        _percent(measures["volume"], "+.2f"),
        _number(measures["flips"]["count"], ","),
    )


def _left_out(measures: dict[str, Any], told: dict[str, Any]) -> list[str]:
    """How much of the shape the figures are not about."""
    said = []
    vertices, degenerate = measures["curvature"]["left_out"], measures["strain"]["degenerate"]
    flips = measures["flips"]["left_out"]
    if vertices:
        said.append(f"curvature and Laplacian without {vertices:,} vertices, on triangles without area or on none")
    if degenerate:
        said.append(f"strain without {degenerate:,} of {told['triangles']:,} triangles, without area")
    if flips:
        said.append(f"flipped without {flips:,} triangles: without area or neighbours, or the other side of a sheet")
    return said


def _flat(content: dict[str, Any], before: str = "") -> dict[str, Any]:
    """The values of nested documents, under joined names."""
    flat: dict[str, Any] = {}
    for name, value in content.items():
        flat |= _flat(value, f"{before}{name}_") if isinstance(value, dict) else {f"{before}{name}": value}
    return flat


def _known(content: dict[str, Any]) -> dict[str, Any]:
    """The document with None where a figure is that of nothing (NaN), which JSON has no word for."""
    return {
        name: _known(value) if isinstance(value, dict) else None if value != value else value
        for name, value in content.items()
    }


def _half(value: float | None) -> float | None:
    return None if value is None else value / 2


def _number(value: float | None, digits: str) -> str:
    return "-" if value is None else format(value, digits)


def _percent(part: float | None, digits: str = ".2f") -> str:
    return "-" if part is None else f"{100 * part:{digits}} %"
