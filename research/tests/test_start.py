"""A command that would need a library half an hour from now asks for it at once."""

from __future__ import annotations

import re
import sys
import tomllib
from pathlib import Path

import pytest

from neuralmls.cli import main

RESEARCH = Path(__file__).resolve().parents[1]
MODULES = {"libigl": "igl", "pillow": "PIL"}  # that are not called like the package
ALWAYS = {"click", "neuralmls", "numpy"}


def needed() -> list[str]:
    """The modules of what the package depends on."""
    project = tomllib.loads((RESEARCH / "pyproject.toml").read_text())["project"]
    names = {re.split(r"[<>=]", line)[0] for line in project["dependencies"]} - ALWAYS
    return sorted(MODULES.get(name, name) for name in names)


@pytest.mark.parametrize("module", needed())
def test_reproduce_begins_with_its_libraries(module, monkeypatch, tmp_path, capsys):
    monkeypatch.setitem(sys.modules, module, None)
    for name in [name for name in sys.modules if name.startswith(f"{module}.")]:
        monkeypatch.setitem(sys.modules, name, None)
    assert main(["reproduce", "all", "-o", str(tmp_path)]) == 1
    said = capsys.readouterr().err
    assert re.search(rf"needs? {module}, which is not installed: pip install .* \(in a checkout: ", said, re.IGNORECASE)
    assert list(tmp_path.iterdir()) == []
