"""`neuralmls deform` on an OBJ of a million vertices: seconds and peak memory of the whole process."""

from __future__ import annotations

import tempfile
from pathlib import Path
from statistics import median

import numpy as np

import neuralmls as nm
from benchmarks import child, inputs
from benchmarks.definitions.process import program
from benchmarks.row import Outcome, Row, check
from benchmarks.setting import Setting

SECONDS = 3.0
MEMORY = 16  # times the positions in float64


def run(setting: Setting) -> Outcome:
    """The network's fit included."""
    x, faces = mesh(setting.size(1_000_000))
    shape = inputs.chair()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        source, points, target = folder / "chair.obj", folder / "points.json", folder / "bent.obj"
        write(source, x, faces)
        nm.ControlPoints(shape.p, shape.q).write(points)
        command = [program(), "deform", str(source), "--points", str(points), "-o", str(target), "--force", "--quiet"]
        runs = [child.run(command) for _ in range(min(5, setting.rounds))]
        checked = [answer(source, target)]
    seconds = median(run.seconds for run in runs)
    peak = float(max(run.peak for run in runs))
    what = f"neuralmls deform, {len(x):,} vertices, {len(faces):,} faces"
    rows = [
        Row(what, seconds, bar=setting.bar(SECONDS)),
        Row("  peak memory", peak, bar=setting.bar(MEMORY * x.nbytes), unit="B"),
    ]
    return Outcome("a million vertices", rows, checked, [])


def mesh(count: int) -> tuple[np.ndarray, np.ndarray]:
    """The chair, each triangle cut into a grid as fine as its sides need: about `count` vertices, grids not joined."""
    shape = inputs.chair()
    corners = shape.vertices[shape.triangles]
    sides = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    low, high = 0.0, 1e6  # cuts a metre
    for _ in range(60):
        middle = (low + high) / 2
        cuts = np.maximum(1, np.ceil(sides * middle)).astype(int)
        low, high = (middle, high) if ((cuts + 1) * (cuts + 2) // 2).sum() < count else (low, middle)
    cuts = np.maximum(1, np.ceil(sides * high)).astype(int)
    vertices, faces, base = [], [], 0
    for k in np.unique(cuts):
        chosen = corners[cuts == k]
        at, cells = grid(int(k))
        vertices.append((at @ chosen).reshape(-1, 3))
        starts = base + len(at) * np.arange(len(chosen))
        faces.append((cells + starts[:, None, None]).reshape(-1, 3))
        base += len(vertices[-1])
    return np.concatenate(vertices), np.concatenate(faces)


def grid(k: int) -> tuple[np.ndarray, np.ndarray]:
    """A triangle with its sides cut into k: barycentric coordinates and faces."""
    index = {(i, j): n for n, (i, j) in enumerate((i, j) for i in range(k + 1) for j in range(k + 1 - i))}
    at = np.array([(k - i - j, i, j) for i, j in index]) / k
    up = [(index[i, j], index[i + 1, j], index[i, j + 1]) for i in range(k) for j in range(k - i)]
    down = [(index[i + 1, j], index[i + 1, j + 1], index[i, j + 1]) for i in range(k) for j in range(k - i - 1)]
    return at, np.array(up + down)


def write(path: Path, x: np.ndarray, faces: np.ndarray) -> None:
    """A plain OBJ."""
    with open(path, "w", encoding="ascii") as file:
        file.writelines(f"v {a:.6f} {b:.6f} {c:.6f}\n" for a, b, c in x.tolist())
        file.writelines(f"f {a} {b} {c}\n" for a, b, c in (faces + 1).tolist())


def answer(source: Path, target: Path) -> str:
    """The file written against the library, and the faces as they were."""
    shape, bent = nm.read(source), nm.read(target)
    given = inputs.chair()
    weights = nm.NeuralWeights.fit(given.p, bounds=shape.bounds, seed=0)
    right = nm.Deformer(shape.positions, weights).deform(given.q, adherence=1.0)
    if not np.array_equal(shape.faces, bent.faces):
        return check("faces that changed", float("nan"), 0)
    return check("the file written against the library", float(np.abs(bent.positions - right).max()), 1e-5)
