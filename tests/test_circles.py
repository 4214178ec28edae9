"""No file imports another that imports it, directly or by way of others: each can be read with what lies below it."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.imports import circles, python_imports, rust_imports, typescript_imports

ROOT = Path(__file__).resolve().parents[1]
PACKAGES = ("python/neuralmls", "research/neuralmls_research", "benchmarks")
CRATES = sorted(path.parent.name for path in ROOT.glob("crates/*/src"))


def said(found: list[list[str]]) -> str:
    return "import circles: " + "; ".join(" - ".join(group) for group in found)


@pytest.mark.parametrize("package", PACKAGES)
def test_python_modules_do_not_import_each_other(package: str) -> None:
    graph = python_imports(ROOT / package)
    assert sum(map(len, graph.values())) > 5  # or nothing was read
    assert not (found := circles(graph)), said(found)


@pytest.mark.parametrize("crate", CRATES)
def test_files_of_a_crate_do_not_use_each_other(crate: str) -> None:
    graph = rust_imports(ROOT / "crates" / crate / "src")
    assert not (found := circles(graph)), said(found)


def test_files_of_the_editor_do_not_import_each_other() -> None:
    graph = typescript_imports(ROOT / "editor" / "src")
    assert sum(map(len, graph.values())) > 50
    assert not (found := circles(graph)), said(found)


def test_circles_are_found_through_functions_types_braces_and_names_handed_on(tmp_path: Path) -> None:
    for name, text in {
        "pack/__init__.py": "",
        "pack/a.py": "def f():\n    from pack import b\n",
        "pack/b.py": "from pack.c import x\n",
        "pack/c.py": "from pack.a import f\nx = 1\n",
        "src/lib.rs": "mod a;\nmod b;\nmod c;\npub use a::Thing;\n",
        "src/a.rs": "use crate::{b::{self, Other as O}, c};\n",
        "src/b/mod.rs": "mod inner;\npub use inner::Other;\n",
        "src/b/inner.rs": "use crate::Thing;\n#[cfg(test)]\nmod tests {\n    use crate::c::x;\n}\n",
        "src/c.rs": "// use crate::a::Thing;\npub(crate) fn x() {}\n",
        "ts/a.ts": 'import type { B } from "./deep/b.ts";\n',
        "ts/deep/b.ts": 'export { a } from "../a.ts";\n',
    }.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    assert circles(python_imports(tmp_path / "pack")) == [["pack.a", "pack.b", "pack.c"]]
    assert circles(rust_imports(tmp_path / "src")) == [["a", "b::inner"]]
    assert circles(typescript_imports(tmp_path / "ts")) == [["a.ts", "deep/b.ts"]]
