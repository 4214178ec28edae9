"""What is not installed is named with a command that gets it: by name, and from a checkout."""

from __future__ import annotations

import re
import sys
import tomllib
from pathlib import Path

import numpy as np
import pytest

import neuralmls as nm
from neuralmls.extras import RESEARCH, extra

ROOT = Path(__file__).resolve().parents[1]


def test_shape_aware_weights_without_scipy(monkeypatch):
    monkeypatch.setitem(sys.modules, "scipy.spatial", None)
    words = re.escape("need SciPy, which is not installed: pip install 'neuralmls[shape-aware]' (in a checkout: ")
    with pytest.raises(nm.NeuralMLSError, match=words):
        nm.ShapeAwareWeights.fit([[0.0, 0, 0], [1, 0, 0]], np.eye(3), [[0, 1, 2]])


def test_both_ways_are_named():
    assert extra("figures") == "pip install 'neuralmls[figures]' (in a checkout: pip install --editable '.[figures]')"


def test_every_extra_and_package_that_a_message_names_is_there():
    ours = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["optional-dependencies"]
    named = {
        name
        for path in (ROOT / "python").rglob("*.py")
        for name in re.findall(r"""(?:neuralmls\[|extra\(["'])([\w-]+)""", path.read_text())
    }
    assert named == {"figures", "shape-aware"} <= set(ours)
    research = tomllib.loads((ROOT / "research" / "pyproject.toml").read_text())["project"]
    assert f"pip install {research['name']} (in a checkout: pip install ./research)" == RESEARCH
