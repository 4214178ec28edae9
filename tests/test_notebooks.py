"""The notebooks run from the first cell to the last, and those that are committed are theirs, run, and small."""

from __future__ import annotations

import nbformat
import pytest

from tools import notebooks

LARGEST = 400_000  # bytes, of a notebook with its pictures
SOURCES = notebooks.sources()


@pytest.mark.parametrize("source", SOURCES, ids=lambda path: path.stem)
def test_every_cell_runs(source, monkeypatch):
    monkeypatch.delenv("MPLBACKEND", raising=False)  # the kernel draws into the notebook
    ran = notebooks.run(source)
    outputs = [output for cell in ran.cells for output in cell.get("outputs", [])]
    assert not [output for output in outputs if output.output_type == "error" or output.get("name") == "stderr"]
    assert sum("image/png" in output.get("data", {}) for output in outputs) >= 2


@pytest.mark.parametrize("source", SOURCES, ids=lambda path: path.stem)
def test_what_is_committed_has_the_cells_of_its_source_with_their_outputs(source):
    file = source.with_suffix(".ipynb")
    assert file.stat().st_size < LARGEST
    kept = nbformat.read(file, as_version=4)
    nbformat.validate(kept)
    made = notebooks.cells(source.read_text(encoding="utf-8"))
    assert [(cell.cell_type, cell.source) for cell in kept.cells] == [
        (cell.cell_type, cell.source) for cell in made.cells
    ], f"python tools/notebooks.py {source.stem}"
    code = [cell for cell in kept.cells if cell.cell_type == "code"]
    assert [cell.execution_count for cell in code] == list(range(1, len(code) + 1))
    assert any("image/jpeg" in output.get("data", {}) for cell in code for output in cell.outputs)


def test_there_are_four_and_each_has_a_source():
    assert len(SOURCES) == 4
    assert {path.stem for path in notebooks.FOLDER.glob("*.ipynb")} == {path.stem for path in SOURCES}


def test_a_source_is_read_as_cells_of_text_and_code():
    made = notebooks.cells("# %% [markdown]\n# # Title\n#\n# Text\n\n# %%\nx = 1\n\n\n# %%\n# a comment\nx\n")
    assert [(cell.cell_type, cell.source) for cell in made.cells] == [
        ("markdown", "# Title\n\nText"),
        ("code", "x = 1"),
        ("code", "# a comment\nx"),
    ]


def test_a_cell_that_fails_is_told(tmp_path):
    source = tmp_path / "broken.py"
    source.write_text("# %%\nimport neuralmls\n\n# %%\nneuralmls.read('nowhere.obj')\n")
    with pytest.raises(Exception, match=r"nowhere\.obj"):
        notebooks.run(source)
