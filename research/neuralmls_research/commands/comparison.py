"""What a comparison says: a document and a CSV file for machines, two tables and a scatter for people."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any, TextIO

from neuralmls import Shape
from neuralmls.cli.plugin import console
from neuralmls.plugin import write_atomically
from neuralmls_research.experiments.compare import Result
from neuralmls_research.experiments.methods import Method
from neuralmls_research.experiments.naming import OURS, description_of
from neuralmls_research.experiments.seeds import deviation_of, mean_of, other_orders

ARRIVED = 1e-6  # of half of the longest side: logits in single precision know no less, and a logarithm would show noise
# By which methods are ranked: smaller is better.
RANKED = {
    "off targets, at the point": "at_points",
    "off targets, nearest vertex": "at_vertices",
    "curvature": "curvature.mean",
    "curvature, median": "curvature.median",
    "Laplacian": "laplacian.mean",
    "Dirichlet": "strain.dirichlet_mean",
    "Dirichlet, median": "strain.dirichlet_median",
}


def document(shape: Shape, methods: Mapping[str, list[Method]], results: Mapping[str, list[Result]]) -> dict[str, Any]:
    """Everything that was measured; lengths in halves of the longest side of the shape's box.

    Parameters
    ----------
    methods, results : by name, one for each seed, or one where there is nothing random
    """
    told = []
    for name, runs in results.items():
        measures = [None if run.measures is None else _known(asdict(run.measures)) for run in runs]
        entry = {
            "name": name,
            "title": runs[0].title,
            "settings": dict(methods[name][0].settings) or None,
            "seconds": mean_of([run.seconds for run in runs]),
            "not_applicable": next((run.reason for run in runs if run.reason is not None), None),
            "measures": mean_of(measures),
        }
        if len(runs) > 1:
            seeds = [method.seed for method in methods[name]]
            each = [{"seed": seed, "measures": found} for seed, found in zip(seeds, measures, strict=True)]
            entry |= {"deviation": deviation_of(measures), "seeds": each}
        told.append(entry)
    count = 0 if shape.faces is None else len(shape.faces)
    return {"vertices": len(shape.positions), "triangles": count, "methods": told, "other_orders": _orders(told)}


def _orders(methods: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """For each of the measures that are ranked, the pairs of methods whose order hangs on the seed."""
    seeds = next(([run["seed"] for run in method["seeds"]] for method in methods if "seeds" in method), [])
    found: list[dict[str, Any]] = []
    for label, path in RANKED.items():
        values = {}
        for method in methods:
            runs = [_at(run["measures"], path) for run in method.get("seeds", [method])]
            if None not in runs:
                values[method["name"]] = runs
        found += [{"measure": label, **asdict(pair)} for pair in other_orders(values, seeds)] if seeds else []
    return found


def _at(measures: Any, path: str) -> Any:
    """The figure at a path of names, as "curvature.mean"; None where there is none."""
    for name in path.split("."):
        measures = None if measures is None else measures[name]
    return measures


def write_csv(path: Path, methods: list[dict[str, Any]]) -> None:
    """Write a row a method and a column a figure, empty where there is none."""
    flat = []
    for method in methods:
        figures = {name: value for name, value in method.items() if name not in ("measures", "seeds", "settings")}
        flat.append(_flat(figures | {"settings": method["settings"] or {}} | (method["measures"] or {})))
    names = dict.fromkeys(name for row in flat for name in row)
    out = io.StringIO()
    writer = csv.DictWriter(out, list(names), lineterminator="\n")
    writer.writeheader()
    writer.writerows(flat)
    write_atomically(path, out.getvalue().encode())


def draw_scatter(path: Path, results: Mapping[str, list[Result]]) -> None:
    """Draw each method's distortions against its control-point errors, at the vertices and at the points themselves."""
    from neuralmls_research.scatter import Panel, scatter

    x_labels = {
        "at_vertices": "vertices nearest to the control points\noff the targets, mean, % of the longest side",
        "at_points": "control points themselves, of maps of space\noff the targets, mean, % of the longest side",
    }
    y_labels = {
        "laplacian": "change of the Laplacian, mean, the shape in [-1, 1]",
        "curvature": "change of mean curvature, mean, the shape in [-1, 1]",
    }
    rows = [
        [Panel(_marks(results, error, distortion), x_label, y_label) for error, x_label in x_labels.items()]
        for distortion, y_label in y_labels.items()
    ]
    scatter(rows, path)


def _marks(results: Mapping[str, list[Result]], error: str, distortion: str) -> dict[str, list[tuple[float, float]]]:
    """A mark for each run that has both, the seeds of a method alike."""
    marks: dict[str, list[tuple[float, float]]] = {}
    for runs in results.values():
        own = marks.setdefault(runs[0].title, [])
        for run in runs:
            off, change = getattr(run.measures, error, None), getattr(run.measures, distortion, None)
            if off is not None and change is not None:
                own.append((100 * off / 2 if off > ARRIVED else 0.0, change.mean))
    return marks


def show(told: dict[str, Any], file: TextIO) -> None:
    """Print the tables, what was left out, and why methods do not apply."""
    done = [method for method in told["methods"] if method["measures"] is not None]
    vertices, triangles = f"{told['vertices']:,}", f"{told['triangles']:,}"
    console.line(f"{told['input']}: {vertices} vertices, {triangles} triangles", file)
    rows = [
        (
            method["title"],
            _figure(method, "at_points", "{:.2f}", 50, " %"),
            _figure(method, "at_vertices", "{:.2f}", 50, " %"),
            _figure(method, "folded", "{:,}"),
            f"{method['seconds']:.2f}",
        )
        for method in done
    ]
    head = ["method", "off targets, at the point", "nearest vertex", "vertices folded", "seconds"]
    console.table(head, rows, (1, 2, 3, 4), file)
    surfaces = [method for method in done if method["measures"]["strain"] is not None]
    if surfaces:
        print(file=file)
        head = ["distortion", "curvature", "median", "Laplacian", "Dirichlet", "median", "area", "edges", "volume"]
        console.table([*head, "flipped"], [_distortion(method) for method in surfaces], range(1, 10), file)
        for sentence in _left_out(surfaces[0]["measures"], told):
            console.line(f"  {sentence}", file)
    _show_settings(done, file)
    _show_seeds(told, file)
    if any(OURS in method["title"] for method in done):
        console.line(f"{OURS}: not in the paper", file)
    reasons = [(m["title"], m["not_applicable"]) for m in told["methods"] if m["not_applicable"] is not None]
    if reasons:
        print("\nwhat does not apply", file=file)
        console.pairs(reasons, file)
    for name in told["files"]:
        console.line(f"  wrote {name}", file)


def _show_settings(done: list[dict[str, Any]], file: TextIO) -> None:
    pairs = []
    for method in done:
        if method["settings"]:
            settings = method["settings"]
            if "seeds" in method:  # which are said below
                weights = {name: value for name, value in settings["weights"].items() if name != "seed"}
                settings = settings | {"weights": weights}
            pairs.append((method["name"], description_of(settings)))
    if pairs:
        print("\nsettings", file=file)
        console.pairs(pairs, file)


def _show_seeds(told: dict[str, Any], file: TextIO) -> None:
    """Say how many trainings the figures are of, and which seeds put methods into another order."""
    seeds = next(([run["seed"] for run in method["seeds"]] for method in told["methods"] if "seeds" in method), None)
    if seeds is None:
        return
    names = ", ".join(method["name"] for method in told["methods"] if "seeds" in method)
    print(file=file)
    console.line(f"mean ± deviation over seeds {seeds[0]} to {seeds[-1]}: {names}", file)
    for pair in told["other_orders"]:
        console.line(f"  {pair['measure']}: {order_said(pair)}", file)
    if not told["other_orders"]:
        console.line("  no seed changes an order of methods", file)


def order_said(pair: Mapping[str, Any]) -> str:
    """In words, that the order of two methods hangs on the seed."""
    seeds = pair["seeds"]
    own = f"seed{'s' if len(seeds) > 1 else ''} {', '.join(map(str, seeds))}"
    return f"{pair['better']} is better than {pair['worse']} on the mean, but not with {own}"


def _distortion(method: dict[str, Any]) -> tuple[str, ...]:
    return (
        method["title"],
        _figure(method, "curvature.mean", "{:.4g}"),
        _figure(method, "curvature.median", "{:.4g}"),
        _figure(method, "laplacian.mean", "{:.3g}"),
        _figure(method, "strain.dirichlet_mean", "{:.4g}"),
        _figure(method, "strain.dirichlet_median", "{:.4g}"),
        _figure(method, "strain.area_mean", "{:.2f}", 100, " %"),
        _figure(method, "strain.edge_mean", "{:.2f}", 100, " %"),
        _figure(method, "volume", "{:+.2f}", 100, " %"),
        _figure(method, "flips.count", "{:,}"),
    )


def _figure(method: dict[str, Any], path: str, form: str, factor: float = 1, unit: str = "") -> str:
    """A figure in words, with its deviation over seeds where there are several; - where there is none."""
    value = _at(method["measures"], path)
    if value is None:
        return "-"
    if "deviation" in method and form == "{:,}":
        form = "{:,.1f}"  # a mean of counts
    text = form.format(factor * value)
    if "deviation" in method:
        text += f" ± {form.replace('+', '').format(factor * _at(method['deviation'], path))}"
    return text + unit


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
