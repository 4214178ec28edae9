"""The command line, run in this process or as its own, in an empty folder with a small shape in it."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from neuralmls.cli import main

PROGRAM = "import sys; from neuralmls.cli import main; sys.exit(main())"

# Two quads, one above the other, with things that a deformation has nothing to do with.
SHAPE = """\
# a comment, and  two  blanks
g lower
v 0 0 0
v 1 0 0
v 1 0 1.50
v 0 0 1.5
vt 0.25 0.5
f 1/1 2/1 3/1 4/1
g upper
usemtl oak
v 0 2 0
v 1 2 0
v 1 2 1.5
v 0 2 1.5
f -4 -3 -2 -1
"""
POINTS = "name,x,y,z\nfoot,0.5,0,0.5\nside,1,1,0.5\ntop,0.5,2,0.5\n"


@dataclass
class Ran:
    """How a command ended."""

    code: int
    out: Any
    err: Any


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty folder with shape.obj and points.csv, which is the current one."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "shape.obj").write_text(SHAPE)
    (tmp_path / "points.csv").write_text(POINTS)
    return tmp_path


@pytest.fixture
def run(here: Path, capsys: pytest.CaptureFixture[str]) -> Callable[..., Ran]:
    """Run the command line in this process."""

    def runner(*arguments: object) -> Ran:
        code = main([str(argument) for argument in arguments])
        return Ran(code, *capsys.readouterr())

    return runner


@pytest.fixture
def start(here: Path) -> Callable[..., subprocess.Popen[bytes]]:
    """Start the command line, or another program that ends in it, as its own process."""

    def starter(*arguments: object, program: str = PROGRAM, **options: object) -> subprocess.Popen[bytes]:
        environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path), "PYTHONDONTWRITEBYTECODE": "1"}
        command = [sys.executable, "-c", program, *map(str, arguments)]
        pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, **options}
        return subprocess.Popen(command, env=environment, **pipes)  # type: ignore[call-overload]

    return starter


@pytest.fixture
def process(start: Callable[..., subprocess.Popen[bytes]]) -> Callable[..., Ran]:
    """Run the command line as its own process to its end; what it says comes as bytes."""

    def runner(*arguments: object, **options: object) -> Ran:
        with start(*arguments, **options) as running:
            out, err = running.communicate(timeout=120)
        return Ran(running.returncode, out, err)

    return runner


@pytest.fixture
def content(here: Path) -> Callable[[], dict[str, bytes]]:
    """Read every file in the folder and below."""
    return lambda: {str(path.relative_to(here)): path.read_bytes() for path in here.rglob("*") if path.is_file()}


@pytest.fixture
def refused(run: Callable[..., Ran], content: Callable[[], dict[str, bytes]]) -> Callable[..., None]:
    """Check that a command is refused in one sentence that has certain words, and that it leaves no trace."""

    def check(code: int, *arguments: object, words: tuple[str, ...]) -> None:
        before = content()
        ran = run(*arguments)
        lines = ran.err.splitlines()
        assert ran.code == code, ran
        assert ran.out == ""
        assert len(lines) == 1, ran.err
        assert lines[0].startswith("neuralmls: error: ")
        for word in words:
            assert word in lines[0]
        assert content() == before

    return check
