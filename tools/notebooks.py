"""Notebooks from their readable sources: `docs/notebooks/NAME.py` is run and becomes `NAME.ipynb`, with its outputs.

A source is Python in cells: `# %%` begins one of code, `# %% [markdown]` one of text, whose lines are comments.
`python tools/notebooks.py [NAME]...` writes them; the tests run every source, and hold that what is committed has
its cells.
"""

from __future__ import annotations

import base64
import io
import re
import sys
import tempfile
from pathlib import Path

import nbformat
from nbclient import NotebookClient
from nbformat import NotebookNode
from nbformat.v4 import new_code_cell, new_markdown_cell, new_notebook
from traitlets.config import Config

FOLDER = Path(__file__).resolve().parents[1] / "docs" / "notebooks"
QUALITY = 80  # of the pictures that are kept, in percent of JPEG's
KERNEL = {"display_name": "Python 3", "language": "python", "name": "python3"}


def sources() -> list[Path]:
    """The sources, in order."""
    return sorted(FOLDER.glob("*.py"))


def cells(text: str) -> NotebookNode:
    """The notebook of a source, not yet run."""
    made = []
    for kind, body in re.findall(r"^# %%( \[markdown\])?\n(.*?)(?=^# %%|\Z)", text, re.DOTALL | re.MULTILINE):
        if kind:
            body = re.sub(r"^# ?", "", body, flags=re.MULTILINE)
        made.append((new_markdown_cell if kind else new_code_cell)(body.strip()))
    for number, cell in enumerate(made):
        cell["id"] = f"cell-{number}"  # the same each time, so that a change shows only what changed
    return new_notebook(cells=made, metadata={"kernelspec": KERNEL, "language_info": {"name": "python"}})


def run(source: Path) -> NotebookNode:
    """Run a source's notebook in an empty folder.

    Raises
    ------
    nbclient.exceptions.CellExecutionError
        A cell failed.
    """
    notebook = cells(source.read_text(encoding="utf-8"))
    with tempfile.TemporaryDirectory() as folder:
        # By a socket of this machine: by TCP, others on it could read along.
        local = Config({"KernelManager": {"transport": "ipc", "ip": str(Path(folder) / "socket")}})
        work = Path(folder) / "work"
        work.mkdir()
        NotebookClient(notebook, timeout=300, resources={"metadata": {"path": work}}, config=local).execute()
    return notebook


def lighten(notebook: NotebookNode) -> None:
    """Leave away what differs from run to run, and make pictures small: a repository keeps every version."""
    for cell in notebook.cells:
        cell.metadata.clear()
        for output in cell.get("outputs", []):
            data = output.get("data", {})
            if "image/png" in data:
                data["image/jpeg"] = _smaller(data.pop("image/png"))
            if data.keys() & {"image/jpeg", "text/html"}:
                data.pop("text/plain", None)


def _smaller(png: str) -> str:
    """A picture as JPEG, a third of the size; both in base64."""
    from PIL import Image

    out = io.BytesIO()
    Image.open(io.BytesIO(base64.b64decode(png))).convert("RGB").save(out, "JPEG", quality=QUALITY, optimize=True)
    return base64.b64encode(out.getvalue()).decode()


def main(names: list[str]) -> None:
    """Write the notebooks of these names, or all."""
    for source in sources():
        if not names or source.stem in names:
            notebook = run(source)
            lighten(notebook)
            target = source.with_suffix(".ipynb")
            target.write_text(nbformat.writes(notebook) + "\n", encoding="utf-8")
            print(f"{target.name}: {len(notebook.cells)} cells, {target.stat().st_size / 1000:.0f} kB")


if __name__ == "__main__":
    main(sys.argv[1:])
