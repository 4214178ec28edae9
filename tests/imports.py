"""Which file imports which, in Python, Rust and TypeScript, and the circles among them."""

from __future__ import annotations

import ast
import os
import re
from collections.abc import Iterable
from pathlib import Path
from typing import TypeAlias

Graph: TypeAlias = dict[str, set[str]]


def python_imports(folder: Path) -> Graph:
    """Modules of a package (or of a folder that is imported as one), by their dotted names.

    At the head of a file, inside of functions and for types alike. A package counts for its `__init__.py`.
    """
    files = {
        _dotted(path.relative_to(folder.parent)): path
        for path in folder.rglob("*.py*")
        if path.suffix in (".py", ".pyi")
    }
    graph: Graph = {}
    for name, path in files.items():
        found: set[str] = set()
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.ImportFrom):
                inside = (f"{node.module}.{alias.name}" for alias in node.names)
                found |= {full if full in files else str(node.module) for full in inside}
            elif isinstance(node, ast.Import):
                found |= {alias.name for alias in node.names}
        graph[name] = found & files.keys() - {name}
    return graph


def _dotted(path: Path) -> str:
    return ".".join(path.with_suffix("").parts).removesuffix(".__init__")


def rust_imports(source: Path) -> Graph:
    """Files of a crate, by the paths that they name from `crate` or `super` on; tests are passed over.

    A path that goes through another file's `pub use` counts for where the name comes from. What a macro's body names by
    `$crate` is not the file's own, and a parent that calls its children names neither.
    """
    files = {_module(path.relative_to(source)): path for path in source.rglob("*.rs") if path.stem != "tests"}
    texts = {module: _without_tests(path.read_text()) for module, path in files.items()}
    exported = {module: _reexports(module, text, files.keys()) for module, text in texts.items()}
    graph: Graph = {}
    for module, text in texts.items():
        found: set[tuple[str, ...]] = set()
        for path in _paths(text):
            found.add(_home(_absolute(module, path), files.keys(), exported))
        graph[_shown(module)] = {_shown(other) for other in found - {module}}
    return graph


Module: TypeAlias = tuple[str, ...]


def _module(path: Path) -> Module:
    parts = path.with_suffix("").parts
    return parts[:-1] if parts[-1] in ("mod", "lib", "main") else parts


def _shown(module: Module) -> str:
    return "::".join(module) or "lib"


def _without_tests(text: str) -> str:
    """A file's code without comments, and without modules that are compiled for tests only."""
    text = re.sub(r"//[^\n]*", "", text)
    return re.sub(r"#\[cfg\(test\)\]\s*(pub(\([a-z]+\))? )?mod \w+ \{.*?^\}", "", text, flags=re.DOTALL | re.MULTILINE)


def _paths(text: str) -> Iterable[list[str]]:
    """Every path from `crate` or `super` on, those in braces one by one."""
    for found in re.finditer(r"(?<![$\w])((?:crate|super)(?=::)(?:::\w+)*)(?:::(\{[^;]*?\})\s*;)?", text):
        head, braces = found[1].split("::"), found[2]
        yield from ([*head, *rest] for rest in _expanded(braces)) if braces else [head]


def _expanded(braces: str) -> Iterable[list[str]]:
    """The paths in `{a::b, c::{d, e as f}}`."""
    depth, part = 0, ""
    for letter in braces[1:-1] + ",":
        depth += {"{": 1, "}": -1}.get(letter, 0)
        if letter != "," or depth:
            part += letter
            continue
        name, part = part.strip(), ""
        if not name:
            continue
        head, opened, rest = name.partition("{")
        steps = [step for step in head.split(" as ")[0].split("::") if step and step != "self"]
        yield from ([*steps, *more] for more in _expanded("{" + rest)) if opened else [steps]


def _absolute(module: Module, path: list[str]) -> Module:
    steps, at = list(path), module
    if steps[0] == "crate":
        return tuple(steps[1:])
    while steps and steps[0] == "super":
        steps, at = steps[1:], at[:-1]
    return (*at, *steps)


def _reexports(module: Module, text: str, files: Iterable[Module]) -> dict[str, Module]:
    """Names that a file hands on from another: `pub use child::Name`, `pub(crate) use super::other::name`."""
    names: dict[str, Module] = {}
    for found in re.finditer(r"\bpub(?:\([a-z ]+\))? use ([\w:]+?)(?:::(\{[^;]*?\}))?;", text):
        head = found[1].split("::")
        for rest in _expanded(found[2]) if found[2] else [[]]:
            path = [*head, *rest]
            whole = _absolute(module, path) if path[0] in ("crate", "super") else (*module, *path)
            names[path[-1]] = whole
    return names


def _home(path: Module, files: Iterable[Module], exported: dict[Module, dict[str, Module]]) -> Module:
    """The file in which what a path names is written."""
    for length in range(len(path), -1, -1):
        at = path[:length]
        if at in files:
            rest = path[length:]
            onward = exported[at].get(rest[0]) if rest else None
            return _home((*onward, *rest[1:]), files, exported) if onward is not None and onward != path else at
    raise AssertionError(path)


def typescript_imports(source: Path) -> Graph:
    """Files of a folder, by their relative imports, those of types alike."""
    files = {str(path.relative_to(source)): path for path in source.rglob("*.ts*") if ".test." not in path.name}
    graph: Graph = {}
    for name, path in files.items():
        named = re.findall(r"""(?:from|import)\s*\(?\s*["'](\.[^"']*)["']""", path.read_text())
        full = {os.path.normpath(os.path.join(os.path.dirname(name), other)) for other in named}
        graph[name] = full & files.keys() - {name}
    return graph


def circles(graph: Graph) -> list[list[str]]:
    """Groups of files that import each other, directly or by way of others: strongly connected components."""
    reached = {name: _reached(graph, name) for name in graph}
    found = {tuple(sorted({name} | {other for other in reached[name] if name in reached[other]})) for name in graph}
    return [list(group) for group in sorted(found) if len(group) > 1]


def _reached(graph: Graph, start: str) -> set[str]:
    seen: set[str] = set()
    waiting = [start]
    while waiting:
        for other in graph.get(waiting.pop(), set()) - seen:
            seen.add(other)
            waiting.append(other)
    return seen
