"""Every picture as PNG, SVG and PDF, every table as CSV and LaTeX: for pages, talks and papers."""

from __future__ import annotations

import base64
import csv
import io
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from neuralmls.plugin import write_atomically
from neuralmls_research.experiments.reproduce.report import Table

if TYPE_CHECKING:
    from matplotlib.figure import Figure

PICTURES = (".png", ".svg", ".pdf")
TABLES = (".csv", ".tex")
# Nothing that changes from run to run, and letters as letters.
_METADATA: dict[str, Any] = {".png": {}, ".svg": {"Date": None}, ".pdf": {"CreationDate": None}}
VECTORS = {"svg.hashsalt": "neuralmls", "pdf.fonttype": 42}
_PRINTED = 200  # pixels an inch, of shapes in PDF

_LATEX = {
    **{letter: f"\\{letter}" for letter in "&%$#_{}"},
    "\\": r"\textbackslash{}",
    "~": r"\textasciitilde{}",
    "^": r"\textasciicircum{}",
    "|": "$|$",
    "<": "$<$",
    ">": "$>$",
    "°": r"$^\circ$",
    "Δ": r"$\Delta$",
    "²": "$^2$",
    "³": "$^3$",
    "⁻": "$^-$",
    "⁶": "$^6$",
    "\N{MULTIPLICATION SIGN}": r"$\times$",
    "\N{MINUS SIGN}": "$-$",
    "\N{PLUS-MINUS SIGN}": r"$\pm$",
}


def files(name: str, suffixes: Sequence[str]) -> list[str]:
    """The names that a file has in all its formats.

    Examples
    --------
    >>> files("fig2.png", PICTURES)
    ['fig2.png', 'fig2.svg', 'fig2.pdf']
    """
    return [Path(name).with_suffix(suffix).name for suffix in suffixes]


def write_plot(figure: Figure, path: Path, dots: int) -> None:
    """Write a figure of Matplotlib beside `path` in each format: lines and letters stay lines and letters.

    Raises
    ------
    FileError
        A file cannot be written.
    """
    for suffix in PICTURES:
        out = io.BytesIO()
        figure.savefig(out, format=suffix[1:], dpi=dots, metadata=_METADATA[suffix])
        write_atomically(path.with_suffix(suffix), out.getvalue())


def embed(path: Path) -> None:
    """Put a PNG into an SVG and a PDF beside it.

    Raises
    ------
    FileError
        A file cannot be written.
    """
    from PIL import Image

    content = path.read_bytes()
    with Image.open(io.BytesIO(content)) as picture:
        width, height = picture.size
        out = io.BytesIO()
        picture.convert("RGB").save(out, "PDF", resolution=_PRINTED, quality=92, creationDate=None, modDate=None)
    write_atomically(path.with_suffix(".pdf"), out.getvalue())
    svg = (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" height="{height}">'
        f'<image width="{width}" height="{height}" href="data:image/png;base64,{base64.b64encode(content).decode()}"/>'
        "</svg>\n"
    )
    write_atomically(path.with_suffix(".svg"), svg.encode())


def write_table(table: Table, folder: Path) -> None:
    """Write a table as CSV and as LaTeX (booktabs).

    Raises
    ------
    FileError
        A file cannot be written.
    """
    out = io.StringIO()
    csv.writer(out, lineterminator="\n").writerows([table.head, *table.rows])
    write_atomically(folder / f"{table.name}.csv", out.getvalue().encode())
    write_atomically(folder / f"{table.name}.tex", as_latex(table).encode())


def as_latex(table: Table) -> str:
    """The table with the rules of booktabs, its first column to the left, numbers to the right.

    Examples
    --------
    >>> print(as_latex(Table("t", "50 % of it.", ["method", "error"], [["neural", "0.1"]])))
    % needs \\usepackage{booktabs}
    % 50 % of it.
    \\begin{tabular}{lr}
    \\toprule
    method & error \\\\
    \\midrule
    neural & 0.1 \\\\
    \\bottomrule
    \\end{tabular}
    <BLANKLINE>
    """
    columns = "".join(_alignment([row[i] for row in table.rows]) if i else "l" for i in range(len(table.head)))
    head, *rows = (" & ".join(map(latex, row)) + r" \\" for row in [table.head, *table.rows])
    lines = [
        r"% needs \usepackage{booktabs}",
        "% " + " ".join(table.caption.split()),
        rf"\begin{{tabular}}{{{columns}}}",
        r"\toprule",
        head,
        r"\midrule",
        *rows,
        r"\bottomrule",
        r"\end{tabular}",
        "",
    ]
    return "\n".join(lines)


def latex(text: str) -> str:
    """Text that LaTeX prints as it is.

    Examples
    --------
    >>> latex("50 % of a_b")
    '50 \\\\% of a\\\\_b'
    """
    return "".join(_LATEX.get(letter, letter) for letter in text)


def _alignment(cells: Sequence[str]) -> str:
    """To the right for figures, else a paragraph for what is long, else to the left."""
    if max(map(len, cells), default=0) > 60:
        return "p{6cm}"
    return "r" if all(cell[:1].isdigit() or cell[:1] == "-" or cell == "not run" for cell in cells) else "l"
