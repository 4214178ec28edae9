"""No module of a Rust crate imports, by whatever way round, one that imports it."""

from __future__ import annotations

import re
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]


def module(path: Path, source: Path) -> tuple[str, ...]:
    """The names of a file's module, from the crate's root."""
    steps = path.relative_to(source).with_suffix("").parts
    return steps[:-1] if steps[-1] in ("mod", "lib") else steps


def flattened(tree: str) -> list[str]:
    """The paths of a use tree: `a::{b, c::{d}}` is a::b and a::c::d."""
    head, brace, rest = tree.partition("{")
    if not brace:
        return [tree.split(" as ")[0].strip()]
    depth, start, parts = 0, 0, []
    inside = rest[: rest.rindex("}")]
    for at, letter in enumerate(inside + ","):
        depth += (letter == "{") - (letter == "}")
        if letter == "," and not depth:
            parts.append(inside[start:at])
            start = at + 1
    return [head.strip() + path for part in parts if part.strip() for path in flattened(part.strip())]


def imports(path: Path, here: tuple[str, ...], modules: set[tuple[str, ...]]) -> set[tuple[str, ...]]:
    """The modules of the crate that a file imports, but for those that hold it and those that it holds."""
    text = re.split(r"^#\[cfg\(test\)\]\n(?:pub\S* )?mod tests", path.read_text(), maxsplit=1, flags=re.MULTILINE)[0]
    text = re.sub(r"//.*", "", text)
    found = set()
    for tree in re.findall(r"\buse\s+([^;]+);", text):
        for name in flattened(re.sub(r"\s+", " ", tree)):
            steps = name.split("::")
            base: tuple[str, ...]
            if steps[0] == "crate":
                base, steps = (), steps[1:]
            elif steps[0] == "super":
                up = len(steps) - len([step for step in steps if step != "super"])
                base, steps = here[: len(here) - up], steps[up:]
            elif steps[0] == "self" or (*here, steps[0]) in modules:
                base, steps = here, [step for step in steps if step != "self"]
            else:
                continue
            whole = (*base, *steps)
            target = max((whole[:n] for n in range(len(whole) + 1) if whole[:n] in modules), key=len)
            if target != here[: len(target)] and here != target[: len(here)]:
                found.add(target)
    return found


@pytest.mark.parametrize("crate", sorted(path.parent.name for path in ROOT.glob("crates/*/src")))
def test_no_import_goes_round_in_a_circle(crate):
    source = ROOT / "crates" / crate / "src"
    files = {module(path, source): path for path in source.rglob("*.rs") if path.stem != "tests"}
    graph = {here: imports(path, here, set(files)) for here, path in files.items()}
    try:
        tuple(TopologicalSorter(graph).static_order())
    except CycleError as error:
        circle = " -> ".join("::".join(name) or "lib" for name in reversed(error.args[1]))
        pytest.fail(f"crates/{crate}: {circle}")
