"""How cost grows: with points, control points and threads. Each number of threads is a process of its own."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

from benchmarks.row import Outcome, check
from benchmarks.setting import Setting

ROOT = Path(__file__).resolve().parents[2]


def run(setting: Setting) -> Outcome:
    """Points at ten control points, control points at 100k points, on one thread and on two."""
    series: list[dict[str, float | int | str]] = []
    checked: list[str] = []
    for threads in (1, 2):
        done = subprocess.run(
            [sys.executable, "-m", "benchmarks.growing", *(["--quick"] if setting.quick else [])],
            capture_output=True,
            text=True,
            cwd=ROOT,
            env=os.environ | {"RAYON_NUM_THREADS": f"{threads}"},
        )
        if done.returncode:
            raise RuntimeError(f"growth, {threads} threads: {done.stderr.strip()[-2000:]}")
        for line in json.loads(done.stdout):
            error = line.pop("error")
            checked.append(
                check(f"logits, {line['points']:,} points, {line['control points']} control points", error, 1e-4)
            )
            series.append({"threads": threads, **line})
    return Outcome("how cost grows (medians)", [], checked, series)
