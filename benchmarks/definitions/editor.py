"""The browser editor in Chromium: first load, refit, a frame of a drag; the shader against the core. By Playwright."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import tempfile
from pathlib import Path

from benchmarks.definitions.process import program
from benchmarks.row import Outcome, Row, check
from benchmarks.setting import Setting

ROOT = Path(__file__).resolve().parents[2]
TITLE = "the browser editor"


def run(setting: Setting) -> Outcome:
    """Bars and rounds stand in editor/tests/bench; without a built editor nothing is held."""
    built = (ROOT / "python/neuralmls/editor_server/static/index.html").is_file()
    if not built or not (ROOT / "editor/node_modules").is_dir() or not shutil.which("npm"):
        return Outcome(TITLE, [], ["the editor is not built, so that its bars are not held: make editor"], [])
    with tempfile.TemporaryDirectory() as name:
        figures = Path(name) / "figures.json"
        environment = {"NEURALMLS": program(), **os.environ, "NEURALMLS_FIGURES": str(figures)}
        environment["NEURALMLS_QUICK"] = "1" if setting.quick else "0"
        command = ["npm", "run", "--silent", "bench"]
        ran = subprocess.run(command, cwd=ROOT / "editor", env=environment, capture_output=True, text=True, check=False)
        if ran.returncode:
            raise RuntimeError(f"the editor's benchmark has failed:\n{ran.stdout[-3000:]}{ran.stderr[-1000:]}")
        told = json.loads(figures.read_text())
    rows = [
        Row(figure["what"], figure["value"], bar=figure["bar"] and setting.bar(figure["bar"]), unit=figure["unit"])
        for figure in told["figures"]
    ]
    answers = [check(answer["what"], answer["error"], answer["tolerance"]) for answer in told["answers"]]
    return Outcome(TITLE, rows, [*answers, *told["notes"]], [])
