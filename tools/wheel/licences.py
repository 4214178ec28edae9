"""`licences.py FILE`: the licence texts of all that is compiled or bundled into a wheel, each text once.

Crates of the compiled core and of the editor's WebAssembly, Rust's standard library, and the npm packages of the
editor. What only runs while they are built (procedural macros, tools, tests) is not in the wheel, nor its licence.
"""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
EDITOR = ROOT / "editor"
PARTS = [("neuralmls-python", "x86_64-unknown-linux-gnu"), ("neuralmls-wasm", "wasm32-unknown-unknown")]
NAMES = ("LICENSE", "LICENCE", "COPYING", "NOTICE", "UNLICENSE")


def main() -> None:
    """Write the file, or say whose licence is missing."""
    holders: dict[str, list[str]] = {}
    for name, texts in {*crates(), standard_library(), *packages()}:
        if not texts:
            sys.exit(f"licences: {name}: no licence text in its package")
        for text in texts:
            holders.setdefault(text, []).append(name)
    ordered = sorted((sorted(names), text) for text, names in holders.items())
    parts = [
        "The wheel of NeuralMLS has these parts of other people in it, under the licences below each list of them.\n"
    ]
    parts += ["=" * 100 + "\n" + "\n".join(names) + "\n\n" + text + "\n" for names, text in ordered]
    Path(sys.argv[1]).write_text("\n".join(parts), encoding="utf-8")


def crates() -> Iterator[tuple[str, tuple[str, ...]]]:
    """Each crate that is linked into one of the two modules."""
    for part, target in PARTS:
        metadata = json.loads(run("cargo", "metadata", "--format-version=1", "--locked", f"--filter-platform={target}"))
        packages = {package["id"]: package for package in metadata["packages"]}
        for package in linked(part, packages, {node["id"]: node for node in metadata["resolve"]["nodes"]}):
            if package["source"] is not None:
                yield f"{package['name']} {package['version']}", texts(Path(package["manifest_path"]).parent)


def linked(part: str, packages: dict[str, Any], nodes: dict[str, Any]) -> list[dict[str, Any]]:
    """What a crate is linked with, itself included."""
    found: dict[str, dict[str, Any]] = {}
    left = [next(id for id, package in packages.items() if package["name"] == part)]
    while left:
        id = left.pop()
        package = packages[id]
        if id in found or any("proc-macro" in target["kind"] for target in package["targets"]):
            continue
        found[id] = package
        left += [
            other["pkg"] for other in nodes[id]["deps"] if any(kind["kind"] is None for kind in other["dep_kinds"])
        ]
    return list(found.values())


def standard_library() -> tuple[str, tuple[str, ...]]:
    """Rust's own, of which either licence may be chosen."""
    path = Path(run("rustc", "--print", "sysroot").strip()) / "share/doc/rust/licenses/MIT.txt"
    if not path.is_file():
        sys.exit(f"licences: {path} is missing: wheels are built with Rust from https://rustup.rs")
    return "the Rust standard library", (path.read_text(encoding="utf-8").strip(),)


def packages() -> Iterator[tuple[str, tuple[str, ...]]]:
    """The npm packages that the editor depends on; the first line is the editor itself."""
    listed = run("npm", "ls", "--omit=dev", "--all", "--parseable", folder=EDITOR).split()
    for folder in map(Path, listed[1:]):
        package = json.loads((folder / "package.json").read_text(encoding="utf-8"))
        yield f"{package['name']} {package['version']}", texts(folder)


def texts(folder: Path) -> tuple[str, ...]:
    """The licence texts of a package."""
    files = sorted(path for path in folder.iterdir() if path.name.upper().startswith(NAMES) and path.is_file())
    return tuple(path.read_text(encoding="utf-8").strip() for path in files)


def run(*command: str, folder: Path = ROOT) -> str:
    """What a command prints."""
    return subprocess.run(command, cwd=folder, check=True, stdout=subprocess.PIPE, encoding="utf-8").stdout


if __name__ == "__main__":
    main()
