"""The commands are there under `neuralmls`, with help."""

from __future__ import annotations

from importlib.metadata import entry_points

import pytest

from neuralmls.cli.main import RESEARCH_COMMANDS
from neuralmls_research.experiments.methods import METHODS
from neuralmls_research.experiments.poses import POSE_METHODS

GROUPS = (("benchmark", "poses"), ("study", "build"), ("study", "report"))


def test_the_tool_knows_the_names_of_what_is_installed():
    ours = [entry.name for entry in entry_points(group="neuralmls.commands") if "neuralmls_research" in entry.value]
    assert sorted(ours) == sorted(RESEARCH_COMMANDS)


@pytest.mark.parametrize("command", [*((name,) for name in RESEARCH_COMMANDS), *GROUPS], ids=" ".join)
def test_every_command_has_help_of_at_most_80_columns(run, command):
    ran = run(*command, "-h")
    assert (ran.code, ran.err) == (0, "")
    assert f"Usage: neuralmls {' '.join(command)}" in ran.out
    assert max(map(len, ran.out.splitlines())) <= 80


def test_help_names_every_method_to_choose_from(run):
    for command, names in ((["compare"], METHODS), (["benchmark", "poses"], POSE_METHODS)):
        told = "".join(run(*command, "--help").out.split())  # lines break at hyphens
        for name in names:
            assert name in told, command
