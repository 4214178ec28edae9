"""What `neuralmls`, `--help` and `--version` do, and how soon."""

from __future__ import annotations

import os
import subprocess
import sys
from importlib.metadata import PackageNotFoundError, version

import pytest

import neuralmls

COMMANDS = ("deform", "inspect", "points", "render", "sample", "demo")
PROGRAM = "import sys; from neuralmls.cli import main; sys.exit(main())"
# Starts a command with a standard stream that is closed, as a shell does by `>&-`.
CLOSED = "import os, sys; os.close({0}); os.execv(sys.executable, [sys.executable, '-c', {1!r}, *sys.argv[1:]])"


def test_help_lists_every_command(run):
    ran = run("--help")
    assert ran.code == 0
    assert ran.err == ""
    for command in COMMANDS:
        assert f"\n  {command} " in ran.out


def test_no_command_shows_help(run):
    assert run().out == run("--help").out


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_has_help_of_at_most_80_columns(run, command):
    ran = run(command, "-h")
    assert ran.code == 0
    assert max(map(len, ran.out.splitlines())) <= 80


@pytest.mark.skipif(sys.platform == "win32", reason="a shell's >&-")
def test_closed_standard_streams(process, here):
    bend = ("deform", "shape.obj", "--points", "points.csv", "--weights", "inverse-distance", "--move", "top=0,1,0")
    ran = process(*bend, "-o", "-", program=CLOSED.format(1, PROGRAM))
    assert ran.code == 1
    assert ran.err.splitlines()[-1].startswith(b"neuralmls: error: standard output: cannot write: ")
    assert b"Traceback" not in ran.err
    assert process(*bend, "-o", "out.obj", program=CLOSED.format(2, PROGRAM)).code == 0
    assert (here / "out.obj").is_file()
    assert process(*bend, "-o", "out.obj", program=CLOSED.format(2, PROGRAM)).code == 2


def test_version(run):
    ran = run("--version")
    assert (ran.code, ran.out) == (0, f"neuralmls {neuralmls.__version__}\n")


def test_version_is_that_of_the_installed_package():
    try:
        installed = version("neuralmls")
    except PackageNotFoundError:
        pytest.skip("the package is not installed, only on the path")
    assert neuralmls.__version__ == installed


@pytest.mark.parametrize("option", ["--help", "--version"])
def test_starts_without_heavy_imports_and_in_less_than_0_3_seconds(option):
    script = (
        "import sys\n"
        "from neuralmls.cli import main\n"
        f"code = main(['{option}'])\n"
        "heavy = {'numpy', 'pyvista', 'rich', 'rich.progress', 'vtkmodules'} & set(sys.modules)\n"
        "sys.exit(f'imported: {heavy}' if heavy else code)\n"
    )
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    best = float("inf")
    for _ in range(5):  # the best of five, in time of the processor: other processes may be about
        before = os.times()
        done = subprocess.run([sys.executable, "-c", script], env=environment, capture_output=True, text=True)
        after = os.times()
        taken = after.children_user + after.children_system - before.children_user - before.children_system
        best = min(best, taken)
        assert done.returncode == 0, done.stderr
    assert best < 0.3
