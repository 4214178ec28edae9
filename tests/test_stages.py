"""`make test` tells each stage with its time, shows what failed, and does not hide what was left out."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from tools import stages

ALL = stages.STAGES
MAKEFILE = """\
good:
\t@echo fine
lazy:
\t@echo "SKIPPED [1] tests/test_x.py:3: no Chromium"
\t@echo "skipped: neither data nor shared/data is there"
\t@echo "test slow ... ignored, takes an hour"
\t@echo "measured: the wheel: 3.0 MB"
bad:
\t@echo what is wrong
\t@false
"""


@pytest.fixture(autouse=True)
def makefile(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Three stages of our own, each a target of a Makefile."""
    (tmp_path / "Makefile").write_text(MAKEFILE)
    monkeypatch.setattr(stages, "ROOT", tmp_path)
    monkeypatch.setattr(stages, "LOGS", tmp_path / "out")
    monkeypatch.setattr(stages, "PLAYWRIGHT", tmp_path / "out" / "e2e.json")
    monkeypatch.setattr(stages, "STAGES", {name: f"the {name} one" for name in ("good", "lazy", "bad")})


def test_a_stage_is_a_line_and_what_it_left_out_is_told_with_its_reason(capsys):
    assert stages.main(["good", "lazy"]) == 0
    out, err = capsys.readouterr()
    lines = re.sub(r"after \d+ s", "after 0 s", out).splitlines()
    assert lines[:6] == [
        "the good one ... passed after 0 s",
        "the lazy one ... passed after 0 s",
        "    measured: the wheel: 3.0 MB",
        "    left out: [1] tests/test_x.py:3: no Chromium",
        "    left out: neither data nor shared/data is there",
        "    left out: slow ... ignored, takes an hour",
    ]
    assert [line.split()[0] for line in lines[7:]] == ["stage", "the", "the", "together", "make"]
    assert err == ""


def test_the_first_that_fails_ends_the_run_and_shows_what_it_said(capsys):
    assert stages.main(["bad", "good"]) == 1
    out, err = capsys.readouterr()
    assert "the bad one ... FAILED" in out
    assert "the good one" not in out
    assert "what is wrong" in err
    assert "make test: FAILED in 'make bad'" in err


def test_what_the_browser_left_out_is_told_with_its_reason():
    test = {"status": "skipped", "annotations": [{"type": "skip", "description": "no real files"}]}
    spec = {"file": "core.spec.ts", "title": "real files", "tests": [test, {"status": "expected", "annotations": []}]}
    report = {"suites": [{"specs": [], "suites": [{"specs": [spec]}]}]}
    assert list(stages.in_browser(json.loads(json.dumps(report)))) == [
        "left out: core.spec.ts: real files: no real files"
    ]


def test_every_stage_is_a_target_of_the_makefile():
    text = (Path(__file__).resolve().parents[1] / "Makefile").read_text()
    for target in ALL:
        assert f"\n{target}:" in text, target
