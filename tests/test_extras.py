"""What is not installed is named with a command that gets it: by name, and from a checkout."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

from neuralmls.extras import RESEARCH, extra

ROOT = Path(__file__).resolve().parents[1]


def test_both_ways_are_named():
    assert extra("figures") == "pip install 'neuralmls[figures]' (in a checkout: pip install --editable '.[figures]')"


def test_every_extra_and_package_that_a_message_names_is_there():
    ours = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["optional-dependencies"]
    named = {
        name
        for path in (ROOT / "python").rglob("*.py")
        for name in re.findall(r"""(?:neuralmls\[|extra\(["'])([\w-]+)""", path.read_text())
    }
    assert named == {"figures"} <= set(ours)
    research = tomllib.loads((ROOT / "research" / "pyproject.toml").read_text())["project"]
    assert f"pip install {research['name']} (in a checkout: pip install ./research)" == RESEARCH
