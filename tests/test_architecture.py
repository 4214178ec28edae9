"""ARCHITECTURE.md says which may import which; here it is held."""

from __future__ import annotations

import ast
import re
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = ROOT / "python" / "neuralmls"


def allowed() -> dict[str, set[str]]:
    block = re.search(r"```imports\n(.*?)```", (ROOT / "ARCHITECTURE.md").read_text(), re.DOTALL)
    assert block
    rules = (line.split(":") for line in block[1].splitlines() if line)
    return {name: set(others.split()) for name, others in rules}


def parts() -> dict[str, list[Path]]:
    """The files of each module or folder of the package."""
    names: dict[str, list[Path]] = {}
    for path in sorted(PACKAGE.rglob("*.py")):
        names.setdefault(path.relative_to(PACKAGE).parts[0].removesuffix(".py"), []).append(path)
    return names


def imported(path: Path) -> set[str]:
    """The parts of the package that a file imports, at its head or inside of functions."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: relative import"
            modules = [
                f"{node.module}.{name.name}" if node.module == "neuralmls" else node.module for name in node.names
            ]
        elif isinstance(node, ast.Import):
            modules = [name.name for name in node.names]
        else:
            continue
        for module in modules:
            steps = (module or "").split(".")
            if steps[0] == "neuralmls":
                part = steps[1] if len(steps) > 1 else "__init__"
                found.add(part if part in parts() or part == "_core" else "__init__")
    return found


@pytest.mark.parametrize("part", parts())
def test_modules_import_only_what_lies_below_them(part):
    rules = allowed()
    assert part in rules, f"ARCHITECTURE.md has no line for {part}"
    for path in parts()[part]:
        too_many = imported(path) - rules[part] - {part}
        assert not too_many, (
            f"{path.relative_to(ROOT)} imports {sorted(too_many)}, which ARCHITECTURE.md does not allow"
        )


@pytest.mark.parametrize("manifest", sorted(ROOT.glob("crates/*/Cargo.toml")), ids=lambda path: path.parent.name)
def test_crates_depend_only_on_what_lies_below_them(manifest):
    crate = f"crates/{manifest.parent.name}"
    dependencies = tomllib.loads(manifest.read_text())["dependencies"]
    paths = {
        f"crates/{Path(value['path']).name}"
        for value in dependencies.values()
        if isinstance(value, dict) and "path" in value
    }
    assert paths <= allowed()[crate]


def test_every_line_is_about_something_that_is_there():
    for name in allowed():
        assert (ROOT / name).is_dir() or name in parts() or (PACKAGE / f"{name}.pyi").is_file(), name


def test_every_folder_has_a_line():
    text = (ROOT / "ARCHITECTURE.md").read_text()
    folders = {path.parent for path in ROOT.glob("crates/*/src")} | {
        ROOT / name for name in ("fuzz", "tests", "docs") if (ROOT / name).is_dir()
    }
    for folder in folders:
        assert f"`{folder.relative_to(ROOT)}`" in text, folder
