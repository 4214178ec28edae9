"""The figures, for people."""

from __future__ import annotations

from rich.console import Console
from rich.table import Table

from benchmarks.machine import Limits
from benchmarks.row import Outcome, Row


def show(outcomes: list[Outcome], console: Console) -> None:
    """Print the table: every bar, and its figure."""
    table = Table("what", "ours", "rival", "rival's", "ratio", "bar", "", "computed limit", title="medians of one run")
    for column in table.columns[1:8]:
        column.justify = "right"
    for outcome in outcomes:
        for row in outcome.rows:
            table.add_row(*cells(row))
        table.add_section()
    console.print(table)
    for outcome in outcomes:
        if outcome.series:
            console.print(series(outcome))


def cells(row: Row) -> list[str]:
    """A row in words."""
    words = {True: "[green]ok[/]", False: "[bold red]missed[/]", None: ""}
    return [
        row.what,
        amount(row.ours, row.unit),
        row.rival,
        "" if row.theirs is None else amount(row.theirs, row.unit),
        "" if row.ratio is None else times(row.ratio) + ("" if row.sense == "faster" else " its time"),
        bar(row),
        words[row.met],
        "" if row.limit is None else amount(row.limit, row.unit),
    ]


def bar(row: Row) -> str:
    """What the row is held against."""
    if row.bar is None:
        return ""
    if row.ratio is None:
        return f"at most {amount(row.bar, row.unit)}"
    return f"at {'least' if row.sense == 'faster' else 'most'} {row.bar:g}x"


def series(outcome: Outcome) -> Table:
    """Figures that belong to no bar, a column for each key."""
    keys = list(outcome.series[0])
    table = Table(*keys, title=outcome.title)
    for line in outcome.series:
        table.add_row(*(amount(value, "s") if isinstance(value, float) else f"{value}" for value in line.values()))
    return table


def limits(found: Limits, threads: int) -> str:
    """What the machine can do, in a sentence."""
    return (
        f"limits: {found.flops / threads / 1e9:.0f} GFLOP/s a thread (sgemm); {threads} threads together copy "
        f"{found.memory / 1e9:.1f} GB/s in memory (read and written), and change 12 MB in place at "
        f"{found.cache / 1e9:.1f} GB/s"
    )


def amount(value: float, unit: str) -> str:
    """Seconds, bytes or a plain number with three digits."""
    if not unit:
        return f"{value:.3g}"
    steps = (("s", 1.0), ("ms", 1e-3), ("us", 1e-6)) if unit == "s" else (("GB", 1e9), ("MB", 1e6), ("kB", 1e3))
    for name, size in steps:
        if value >= size:
            return f"{value / size:.3g} {name}" if value < 999.5 * size else f"{value / size:.0f} {name}"
    return f"{value / steps[-1][1]:.3g} {steps[-1][0]}"


def times(ratio: float) -> str:
    """A ratio with no more digits than it has."""
    return f"{ratio:.0f}x" if ratio >= 99.5 else f"{ratio:.3g}x"
