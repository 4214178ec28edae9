"""ARCHITECTURE.md says which may import which; here it is held."""

from __future__ import annotations

import ast
import re
import tomllib
from pathlib import Path

import pytest

import neuralmls

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


def imports(path: Path) -> list[tuple[str, str | None]]:
    """Modules of this repository that a file imports, each with the name that it takes from it, if it takes one."""
    found: list[tuple[str, str | None]] = []
    tree = ast.parse(path.read_text())
    whole = {
        alias.asname or alias.name
        for node in ast.walk(tree)
        if isinstance(node, ast.Import)
        for alias in node.names
        if alias.name == "neuralmls"
    }
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom):
            found += [(node.module or "", alias.name) for alias in node.names]
        elif isinstance(node, ast.Import):
            found += [(alias.name, None) for alias in node.names]
        elif isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id in whole:
            found.append(("neuralmls", node.attr))
    return [(module, name) for module, name in found if module.partition(".")[0] in ("neuralmls", "neuralmls_research")]


def is_public(module: str, name: str | None, modules: set[str]) -> bool:
    """Whether it is a name of `neuralmls` itself, or one of these modules' or of those below them."""
    if module == "neuralmls" and name is not None:
        return name in neuralmls.__all__ or f"neuralmls.{name}" in modules
    if (name is not None and name.startswith("_")) or "._" in module:
        return False
    return any(f"{module}.".startswith(f"{other}.") for other in modules if other != "neuralmls" or module == other)


@pytest.mark.parametrize("folder", ["research/neuralmls_research", "benchmarks"])
def test_packages_of_their_own_use_public_names_only(folder):
    package = Path(folder).parts[0]
    modules = allowed()[package] | ({"neuralmls_research"} if package == "research" else set())
    used = {found for path in (ROOT / folder).rglob("*.py") for found in imports(path)}
    assert used
    assert not [found for found in used if not is_public(*found, modules)]


def test_what_is_private_is_known_from_what_is_public():
    modules = {"neuralmls", "neuralmls.figures", "neuralmls.cli.plugin"}
    for module, name in (("neuralmls", None), ("neuralmls", "Deformer"), ("neuralmls", "__version__"),
                         ("neuralmls.figures.render", "Panel"), ("neuralmls.cli.plugin", "console")):  # fmt: skip
        assert is_public(module, name, modules), (module, name)
    for module, name in (("neuralmls", "_core"), ("neuralmls._core", "fit"), ("neuralmls", "arrays"),
                         ("neuralmls.cli", "console"), ("neuralmls.figures.render", "_check"),
                         ("neuralmls.figures_more", "x"), ("neuralmls.deformer", "Deformer")):  # fmt: skip
        assert not is_public(module, name, modules), (module, name)


def test_every_line_is_about_something_that_is_there():
    for name in allowed():
        assert (ROOT / name).is_dir() or name in parts() or (PACKAGE / f"{name}.pyi").is_file(), name


def test_every_folder_has_a_line():
    text = (ROOT / "ARCHITECTURE.md").read_text()
    folders = {path.parent for path in ROOT.glob("crates/*/src")} | {
        ROOT / name for name in ("fuzz", "research", "tests", "docs") if (ROOT / name).is_dir()
    }
    for folder in folders:
        assert f"`{folder.relative_to(ROOT)}`" in text, folder
