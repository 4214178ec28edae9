"""What the command line says: results on standard output, everything else on standard error."""

from __future__ import annotations

import json
import sys
import unicodedata
from collections.abc import Iterable, Sequence
from typing import Any, TextIO


def error(sentence: str) -> None:
    """Say what ended the command."""
    line(f"neuralmls: error: {sentence}")


def warning(sentence: str) -> None:
    """Say what the person probably wants to know."""
    line(f"neuralmls: warning: {sentence}")


def line(text: str, file: TextIO | None = None) -> None:
    """Print one line, to standard error unless told otherwise, whatever a file's name holds."""
    print(visible(text), file=sys.stderr if file is None else file)


def visible(text: str) -> str:
    """The text with what is not shown spelled out: a name must not break a line, drive a terminal or turn it round.

    That is control characters, marks of direction and the like, ends of lines and paragraphs, halves of a character.
    """
    if text.isprintable():
        return text
    return "".join(map(_shown, text))


def _shown(character: str) -> str:
    if unicodedata.category(character) in {"Cc", "Cf", "Cs", "Zl", "Zp"}:
        return character.encode("unicode_escape").decode()
    return character


def document(content: dict[str, Any], file: TextIO | None = None) -> None:
    """Print JSON for a machine to read."""
    print(json.dumps(content, indent=2), file=file)


def pairs(rows: Iterable[tuple[str, str]], file: TextIO | None = None) -> None:
    """Print labels and what they are, in two columns."""
    table([], [(label, text) for label, text in rows], file=file)


def table(
    head: Sequence[str], rows: Iterable[Sequence[str]], numbers: Iterable[int] = (), file: TextIO | None = None
) -> None:
    """Print columns, those in `numbers` to the right; what is too wide for the terminal wraps in its cell."""
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    right = set(numbers)
    grid = Table(box=None, show_header=bool(head), pad_edge=False, padding=(0, 3, 0, 0), header_style="bold")
    content = [[visible(cell) for cell in row] for row in rows]
    for column in range(max(map(len, [head, *content]))):
        title = head[column] if head else ""
        first = column == 0
        grid.add_column(
            title,
            justify="right" if column in right else "left",
            overflow="fold",
            no_wrap=first and not head,
            style="dim" if first and not head else "",
        )
    for row in content:
        grid.add_row(*map(Text, row))
    out = sys.stdout if file is None else file
    screen = Console(file=out, highlight=False)
    screen.width = screen.width - 2 if out.isatty() else 200  # 2: the indent
    with screen.capture() as capture:
        screen.print(grid)
    for text in capture.get().splitlines():  # indented, and without the blanks that fill a table's last column
        print(f"  {text}".rstrip(), file=out)
