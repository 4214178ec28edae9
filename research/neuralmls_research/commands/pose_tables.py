"""What `benchmark poses` says: a document for machines, tables for people."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any, TextIO

from neuralmls.cli.plugin import console
from neuralmls_research.commands.comparison import order_said

if TYPE_CHECKING:
    from neuralmls_research.experiments.against_rivals import Measured
    from neuralmls_research.experiments.methods import Method

Methods = Mapping[str, "list[Method]"]  # by name, one for each seed


def document(measured: Sequence[Measured], methods: Methods) -> dict[str, Any]:
    """Everything that was measured, and what it says."""
    from neuralmls_research.experiments.bootstrap import CONFIDENCE

    rows = [
        {
            "file": row.file,
            "control_points": row.control_points,
            "errors": {name: row.mean(name) for name in methods},
            "not_applicable": row.not_applicable,
            "by_seed_and_pose": row.errors,
        }
        for row in measured
    ]
    named = {name: {"title": own[0].title, "settings": dict(own[0].settings) or None} for name, own in methods.items()}
    return {
        "unit": "% of the diagonal of the box at rest",
        "methods": named,
        "seeds": _seeds(methods),
        "rows": rows,
        "confidence": CONFIDENCE,
        "against_best_rival": [_verdict(count, own, methods) for count, own in _by_count(measured)],
    }


def _verdict(count: int, measured: Sequence[Measured], methods: Methods) -> dict[str, Any]:
    """For one number of control points: the ratios, whom they are not against, and what hangs on the seed."""
    from neuralmls_research.experiments.against_rivals import against_rivals, missing, orders_by_seed

    ours, rivals = _sides(methods)
    orders = orders_by_seed(measured, list(methods), _seeds(methods))
    return {
        "control_points": count,
        "rivals": rivals,
        "ratios": {name: asdict(found) for name, found in against_rivals(measured, ours, rivals).items()},
        "without": missing(measured, rivals),
        "other_orders": [asdict(pair) for pair in orders],
    }


def show(measured: Sequence[Measured], methods: Methods, file: TextIO) -> None:
    """Print the errors, the ratios, and why methods do not apply."""
    print("mean error in % of the diagonal", file=file)
    cells = [
        (Path(row.file).stem, str(row.control_points), *(_number(row.mean(name)) for name in methods))
        for row in measured
    ]
    head = ["file", "control points", *methods]
    console.table(head, cells, range(1, len(head)), file)
    print("\nmethods", file=file)
    console.pairs([(name, own[0].title) for name, own in methods.items()], file)
    for row in measured:
        for name, reason in row.not_applicable.items():
            where = f"{Path(row.file).stem}, {row.control_points} control points"
            console.line(f"  {name} does not apply to {where}: {reason}", file)
    ours, rivals = _sides(methods)
    if ours and rivals:
        _show_verdicts([_verdict(count, own, methods) for count, own in _by_count(measured)], _seeds(methods), file)


def _show_verdicts(verdicts: list[dict[str, Any]], seeds: list[int], file: TextIO) -> None:
    from neuralmls_research.experiments.bootstrap import CONFIDENCE

    print(f"\nagainst the best rival of each file: {', '.join(verdicts[0]['rivals'])}", file=file)
    cells = [
        (
            name,
            str(verdict["control_points"]),
            f"{found['ratio']:.3f}",
            f"{found['low']:.3f} to {found['high']:.3f}",
            f"{found['won']} of {found['files']}",
        )
        for verdict in verdicts
        for name, found in verdict["ratios"].items()
    ]
    head = ["method", "control points", "geometric mean", f"{CONFIDENCE:.0%} interval", "won"]
    console.table(head, cells, range(1, len(head)), file)
    for verdict in verdicts:
        count = verdict["control_points"]
        for where, names in verdict["without"].items():
            console.line(f"  {Path(where).stem}, {count} control points: without {', '.join(names)}", file)
        for pair in verdict["other_orders"]:
            console.line(f"  {count} control points: {order_said(pair)}", file)
    if len(seeds) > 1:
        console.line(f"  means over seeds {seeds[0]} to {seeds[-1]}", file)
        if not any(verdict["other_orders"] for verdict in verdicts):
            console.line("  no seed changes an order of methods, by the geometric mean over files", file)


def _sides(methods: Methods) -> tuple[list[str], list[str]]:
    """The names of our methods, and of their rivals."""
    from neuralmls_research.experiments.poses import is_ours

    ours = [name for name, own in methods.items() if is_ours(own[0])]
    return ours, [name for name in methods if name not in ours]


def _seeds(methods: Methods) -> list[int]:
    several: list[Method] = max(methods.values(), key=len)
    return [method.seed for method in several if method.seed is not None]


def _by_count(measured: Sequence[Measured]) -> Iterator[tuple[int, list[Measured]]]:
    for count in dict.fromkeys(row.control_points for row in measured):
        yield count, [row for row in measured if row.control_points == count]


def _number(value: float | None) -> str:
    return "-" if value is None else f"{value:.2f}"
