"""Commands of other packages: listed by name, imported when asked for; what is said where they are not installed."""

from __future__ import annotations

import importlib.metadata
import os
import subprocess
import sys

import pytest

from neuralmls.cli.main import RESEARCH_COMMANDS

COMMAND = """\
import click
from neuralmls.cli.plugin import Stages, console, options

@click.command()
@options.quiet
def greet(*, quiet):
    '''Say hello.'''
    with Stages(quiet=quiet).stage("greet"):
        console.line("hello")
"""


@pytest.fixture
def other_package(here, monkeypatch):
    """A package beside ours with the command `greet`, one that cannot be loaded, and one by the name of ours."""
    (here / "greeting.py").write_text(COMMAND)
    folder = here / "greeting-1.0.dist-info"
    folder.mkdir()
    (folder / "METADATA").write_text("Metadata-Version: 2.1\nName: greeting\nVersion: 1.0\n")
    lines = ("greet = greeting:greet", "broken = greeting.none:broken", "inspect = greeting:greet")
    (folder / "entry_points.txt").write_text("\n".join(["[neuralmls.commands]", *lines, ""]))
    monkeypatch.syspath_prepend(here)
    yield
    sys.modules.pop("greeting", None)


def test_a_command_of_another_package_runs_and_has_help(run, other_package):
    assert run("greet").err == "hello\n"
    assert "Say hello." in run("greet", "--help").out


def test_they_are_listed_by_name_and_not_imported_for_that(run, other_package):
    told = run("--help").out
    assert "Commands of other packages:" in told
    assert "  greeting" in told
    assert "greet, broken" in told
    assert "inspect" not in told[told.index("Commands of other packages:") :]
    assert "greeting" not in sys.modules


def test_a_command_that_cannot_be_loaded_is_one_sentence(refused, other_package):
    refused(1, "broken", words=("'broken' cannot be loaded from greeting.none:broken",))


def test_our_own_commands_are_not_replaced(run, other_package):
    assert "shape.obj: OBJ" in run("inspect", "shape.obj").out


@pytest.mark.parametrize("command", RESEARCH_COMMANDS)
def test_what_measures_is_not_installed(refused, monkeypatch, command):
    monkeypatch.setattr(importlib.metadata, "entry_points", lambda **_: [])
    words = (f"'{command}'", "pip install neuralmls-research", "in a checkout: pip install ./research")
    refused(1, command, "shape.obj", words=words)
    refused(1, command, "--help", words=words)


def test_help_and_our_own_commands_import_nothing_that_measures():
    script = (
        "import sys\n"
        "from neuralmls.cli import main\n"
        "codes = main(['--help']), main(['deform', '--help'])\n"
        "sys.exit(any(name.startswith('neuralmls_research') for name in sys.modules) or any(codes))\n"
    )
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    assert subprocess.run([sys.executable, "-c", script], env=environment, capture_output=True).returncode == 0
