"""One session, one result: `neuralmls deform`, `Map` and `nm.deform` give the same (the editor: editor/tests/e2e).

tests/faces.json has control points of the sample chair, and 23 sessions: settings, frame, what differs in the points.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import neuralmls as nm
from neuralmls.cli import main
from neuralmls.samples import make
from neuralmls.samples.sample import write_obj

FACES: dict[str, Any] = json.loads(Path(__file__).with_name("faces.json").read_text(encoding="utf-8"))
SESSIONS: list[dict[str, Any]] = FACES["sessions"]


@pytest.fixture(scope="module")
def chair(tmp_path_factory: pytest.TempPathFactory) -> nm.Shape:
    path = tmp_path_factory.mktemp("faces") / "chair.obj"
    write_obj(make(FACES["shape"]), path)
    return nm.read(path)


def document(session: dict[str, Any]) -> dict[str, Any]:
    """The session file."""
    points = [{**point, **session["moved"].get(point["name"], {})} for point in FACES["control_points"]]
    kept = {key: session[key] for key in ("settings", "frame") if key in session}
    return {"format": "neuralmls-control-points", "version": 2, "control_points": points, **kept}


def weights_of(session: nm.Session, shape: nm.Shape) -> nm.Weights:
    parameters = {key: value for key, value in session.settings["weights"].items() if key != "kind"}
    box = shape.bounds if session.frame is None else session.frame
    if session.weights == "neural":
        return nm.NeuralWeights.fit(session.points.sources, bounds=box, **parameters)
    if session.weights == "inverse-distance":
        return nm.InverseDistanceWeights(session.points.sources, bounds=box, **parameters)
    return nm.ShapeAwareWeights.fit(session.points.sources, shape.positions, shape.faces, bounds=box, **parameters)


@pytest.mark.parametrize("session", SESSIONS, ids=lambda session: session["name"])
def test_every_face_gives_the_same(session, chair, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("session.json").write_text(json.dumps(document(session)))
    assert main(["deform", str(chair.path), "--points", "session.json", "-o", "told.obj", "-q"]) == 0

    read = nm.Session.read("session.json")
    map = read.fit(chair)
    y, maps = map.deform(chair, return_maps=True)
    chair.write("map.obj", y, maps=maps)
    assert Path("map.obj").read_bytes() == Path("told.obj").read_bytes()
    assert np.abs(y - chair.positions).max() > 0.01
    assert np.array_equal(map.at(chair.positions), y)

    if (read.points.weights != 1).any():
        return  # `nm.deform` has one word for all control points
    called = nm.deform(
        chair.positions,
        read.points.sources,
        read.points.targets,
        rotations=read.points.rotations,
        scales=read.points.scales,
        weights=weights_of(read, chair),
        faces=chair.faces,
        transform=read.settings["transform"],
        temperature=read.settings["temperature"],
        handles=read.settings["handles"],
        relax=read.settings["relax"],
        no_folds=read.settings["no_folds"],
    )
    # Matrices go by way of axis and angle, which rounds.
    assert np.abs(called - y).max() <= (1e-13 if read.points.is_oriented else 0)


def test_the_sessions_are_of_every_kind():
    said = [session["settings"] for session in SESSIONS]
    assert len(SESSIONS) == 23
    assert {settings.get("weights", {}).get("kind") for settings in said} == {
        None,
        "neural",
        "shape-aware",
        "inverse-distance",
    }
    assert {settings.get("transform", "rigid") for settings in said} == {"rigid", "similarity", "affine"}
    assert {settings.get("handles", "auto") for settings in said} == {"auto", "exact", "soft", 0.5}
    assert {settings.get("relax", 0) for settings in said} == {0, 0.4, 1}
    assert {settings.get("no_folds", False) for settings in said} == {False, True}
    temperatures = [settings.get("temperature", 1) for settings in said]
    assert (min(temperatures), max(temperatures)) == (0.1, 10)
    assert any("frame" in session for session in SESSIONS)
    moved = [point for session in SESSIONS for point in session["moved"].values()]
    assert all(any(key in point for point in moved) for key in ("rotation", "scale", "weight"))
