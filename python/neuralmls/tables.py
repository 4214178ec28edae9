"""What a notebook shows of an object: small static tables, in which all text is escaped."""

from __future__ import annotations

import html
from collections.abc import Sequence

MOST_ROWS = 20


def fact_table(title: str, facts: Sequence[tuple[str, str]]) -> str:
    """Return a table of names and what is to be said of each.

    >>> fact_table("a<b", [("vertices", "8")])
    '<table><caption>a&lt;b</caption><tr><th>vertices</th><td>8</td></tr></table>'
    """
    rows = "".join(f"<tr><th>{_safe(name)}</th><td>{_safe(value)}</td></tr>" for name, value in facts)
    return f"<table><caption>{_safe(title)}</caption>{rows}</table>"


def rows_table(title: str, head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Return a table with a head, of which the first rows are shown.

    >>> rows_table("one", ["name"], [["p1"]])
    '<table><caption>one</caption><tr><th>name</th></tr><tr><td>p1</td></tr></table>'
    """
    shown = [_row("th", head), *(_row("td", row) for row in rows[:MOST_ROWS])]
    if len(rows) > MOST_ROWS:
        shown.append(f'<tr><td colspan="{len(head)}">and {len(rows) - MOST_ROWS:,} more</td></tr>')
    return f"<table><caption>{_safe(title)}</caption>{''.join(shown)}</table>"


def _row(kind: str, cells: Sequence[str]) -> str:
    return "<tr>" + "".join(f"<{kind}>{_safe(cell)}</{kind}>" for cell in cells) + "</tr>"


def _safe(text: str) -> str:
    return html.escape(text)
