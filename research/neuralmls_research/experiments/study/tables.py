"""The paper's Table 2 as files: CSV for machines, LaTeX for papers."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from dataclasses import asdict, fields

from neuralmls_research.experiments.study.report import CONFIDENCE, Share

SPECIAL = str.maketrans({character: "\\" + character for character in "&%$#_{}"})


def csv_of(rows: Sequence[Share]) -> str:
    """Return a row a category and method, with every figure.

    >>> csv_of([Share("car", "neural", 3, 4, 0.75, 0.3, 0.95, 0.5)]).splitlines()[1]
    'car,neural,3,4,0.75,0.3,0.95,0.5'
    """
    out = io.StringIO()
    writer = csv.DictWriter(out, [field.name for field in fields(Share)], lineterminator="\n")
    writer.writeheader()
    writer.writerows(map(asdict, rows))
    return out.getvalue()


def latex_of(rows: Sequence[Share], participants: int) -> str:
    """Return a table with a row a category and a column a method, in % with intervals; it needs no package."""
    methods = list(dict.fromkeys(row.method for row in rows))
    by_place = {(row.category, row.method): row for row in rows}
    head = " & ".join(["", *(name.translate(SPECIAL) for name in methods)])
    lines = [
        f"% {participants} participants; chosen where shown, with {CONFIDENCE:.0%} intervals",
        f"\\begin{{tabular}}{{l{'r' * len(methods)}}}",
        "\\hline",
        head + " \\\\",
        "\\hline",
    ]
    for category in dict.fromkeys(row.category for row in rows):
        cells = [_cell(by_place.get((category, method))) for method in methods]
        lines.append(" & ".join([category.translate(SPECIAL), *cells]) + " \\\\")
    return "\n".join([*lines, "\\hline", "\\end{tabular}", ""])


def _cell(row: Share | None) -> str:
    if row is None:
        return "--"
    return f"{100 * row.share:.1f}\\,\\% [{100 * row.low:.1f}, {100 * row.high:.1f}]"
