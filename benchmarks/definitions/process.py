"""`neuralmls deform` as a whole process on a chair, against a process that imports PyTorch and does the same work."""

from __future__ import annotations

import json
import os
import sys
import tempfile
from pathlib import Path
from statistics import median

import numpy as np

import neuralmls as nm
from benchmarks import child
from benchmarks.row import Outcome, Row, check
from benchmarks.setting import Setting
from neuralmls.samples import chair
from neuralmls.samples.sample import write_obj

BAR = 12.0  # times faster
NAME, CASE = "ShapeNetChair1", "user_study_1"
CLOSE = 0.05  # of the longest side: networks from other random numbers bend alike, not the same


def run(setting: Setting) -> Outcome:
    """ShapeNetChair1 from $NEURALMLS_DATA or ../shared/data; the sample chair, and no bar, where there is neither."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        label, source, points = given(folder)
        ours = [program(), "deform", str(source), "--points", str(points), "-o", str(folder / "ours.obj")]
        commands = {"ours": [*ours, "--steps", "48", "--force", "--quiet"]}
        if setting.has("torch"):
            script = Path(__file__).parents[1] / "rivals" / "pytorch_process.py"
            commands["PyTorch"] = [sys.executable, str(script), str(source), str(points), str(folder / "theirs.obj")]
        runs: dict[str, list[child.Run]] = {name: [] for name in commands}
        for _ in range(setting.rounds):
            for contender, command in commands.items():
                runs[contender].append(child.run(command))
        checked = answers(folder, source, points, "PyTorch" in commands)
    seconds = {name: median(run.seconds for run in taken) for name, taken in runs.items()}
    peaks = {name: float(max(run.peak for run in taken)) for name, taken in runs.items()}
    bar = setting.bar(BAR) if label == NAME and "PyTorch" in commands else None
    rival = ("PyTorch, whole process", seconds["PyTorch"]) if "PyTorch" in commands else ("", None)
    memory = ("PyTorch, whole process", peaks["PyTorch"]) if "PyTorch" in commands else ("", None)
    rows = [
        Row(f"neuralmls deform {label}", seconds["ours"], *rival, bar=bar),
        Row("  peak memory", peaks["ours"], *memory, unit="B"),
    ]
    return Outcome("whole process", rows, checked, [])


def program() -> str:
    """The installed command line."""
    found = Path(sys.executable).parent / "neuralmls"
    if not found.is_file():
        raise RuntimeError(f"{found} is not there: neuralmls is not installed in this Python")
    return str(found)


def given(folder: Path) -> tuple[str, Path, Path]:
    """What to bend: its label, the shape, and its control-point file."""
    beside = Path(__file__).resolve().parents[3] / "shared" / "data"
    data = Path(os.environ.get("NEURALMLS_DATA", beside)) / "shapenet"
    points = folder / "points.json"
    if (data / NAME / "model.obj").is_file():
        source = data / NAME / "model.obj"
        low, high = nm.read(source).bounds
        centre, half = (low + high) / 2, (high - low).max() / 2
        case = json.loads((data / "control_points.json").read_text())[NAME]
        p = np.array(case["control_points"]) * half + centre
        q = p + np.array(case["offsets"][CASE]) * half
        nm.ControlPoints(p, q, case["names"]).write(points)
        return NAME, source, points
    source = folder / "chair.obj"
    sample = chair.make()
    write_obj(sample, source)
    sample.control_points.write(points)
    return "the sample chair", source, points


def answers(folder: Path, source: Path, points: Path, theirs: bool) -> list[str]:
    """Ours by the library in this process; PyTorch's by being near ours."""
    shape, given = nm.read(source), nm.ControlPoints.read(points)
    weights = nm.NeuralWeights.fit(given.sources, bounds=shape.bounds, seed=0, steps=48)
    right = nm.Deformer(shape.positions, weights).deform(given.targets, adherence=1.0)
    ours = nm.read(folder / "ours.obj").positions
    side = float(np.ptp(shape.bounds, axis=0).max())
    if np.abs(right - shape.positions).max() < 0.05 * side:
        raise RuntimeError("the control points move nothing, so that nothing is checked")
    checked = [check("the file written against the library", float(np.abs(ours - right).max()) / side, 1e-5)]
    if theirs:
        found = nm.read(folder / "theirs.obj").positions
        checked.append(check("  PyTorch's, of the longest side", float(np.abs(found - ours).max()) / side, CLOSE))
    return checked
