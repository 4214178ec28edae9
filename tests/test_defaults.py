"""A default stands in the core; what a signature or a help text repeats for its readers is held to it."""

from __future__ import annotations

import inspect
import re

import pytest

import neuralmls as nm
from neuralmls.cli import settings

POINTS = nm.ControlPoints([[0.0, 0.0], [1.0, 0.0]])
NEURAL = nm.Session(POINTS).settings
CLASSIC = nm.Session(POINTS, weights="inverse-distance").settings["weights"]
SETTINGS = {**NEURAL, **NEURAL["weights"], **CLASSIC, "weights": NEURAL["weights"]["kind"]}


@pytest.mark.parametrize(
    "call",
    [nm.NeuralWeights.fit, nm.InverseDistanceWeights.__init__, nm.Session.__init__, nm.deform],
    ids=lambda call: call.__qualname__,
)
def test_signatures_have_the_defaults_of_the_core(call):
    parameters = inspect.signature(call).parameters
    said = {name: one.default for name, one in parameters.items() if name in SETTINGS}
    assert said == {name: SETTINGS[name] for name in said}
    assert said


def test_the_help_of_the_command_line_says_the_defaults_of_the_core():
    told = {}
    for option in (*settings.WEIGHTS, *settings.MOTION):
        for parameter in option(lambda: None).__click_params__:
            (default,) = re.findall(r"\[default: ([^]]+)\]$", parameter.help)
            told[parameter.name] = default
    expected = {name: f"{value:g}" if isinstance(value, float) else str(value) for name, value in SETTINGS.items()}
    expected["steps"] = "until the loss is small"
    assert SETTINGS.get("steps") is None
    expected["no_folds"] = "one step"
    assert SETTINGS["no_folds"] is False
    assert told == {name: expected[name] for name in told}
    assert len(told) == len(settings.WEIGHTS) + len(settings.MOTION)
