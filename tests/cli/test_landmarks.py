"""`--points` and `--targets`: every file of control points in tests/sessions, of whatever tool."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import neuralmls as nm

FOLDER = Path(__file__).parents[1] / "sessions"
TABLE = json.loads((FOLDER / "table.json").read_text(encoding="utf-8"))
READ = [entry for entry in TABLE if "read" in entry]
BROKEN = [entry for entry in TABLE if "error" in entry]
CLASSIC = ("--weights", "inverse-distance")


def name_of(entry):
    return "+".join(entry["files"]) + ("-by-order" if entry.get("by_order") else "")


def options(entry):
    points, *targets = (FOLDER / name for name in entry["files"])
    by_order = ("--by-order",) if entry.get("by_order") else ()
    return ("--points", points, *(option for path in targets for option in ("--targets", path)), *by_order)


def cloud(sources):
    """Points all over the box of control points, and a bit beyond."""
    low, high = sources.min(axis=0), sources.max(axis=0)
    middle, half = (low + high) / 2, max(float((high - low).max()), 1e-3) * 0.6
    return middle + half * np.random.default_rng(0).uniform(-1, 1, (30, sources.shape[1]))


@pytest.mark.parametrize("entry", READ, ids=name_of)
def test_every_file_of_control_points_deforms_as_the_package_does(run, here, entry):
    points, *targets = (FOLDER / name for name in entry["files"])
    session = nm.Session.read(points, *targets, by_order=entry.get("by_order", False))
    if not np.abs(session.points.targets).max() < 1e150:
        assert run("deform", "shape.obj", *options(entry), "-o", "out.obj").code == 1
        return
    np.save("cloud.npy", cloud(session.points.sources))
    ran = run("deform", "cloud.npy", *options(entry), "-o", "out.npy", "--json", *CLASSIC)
    assert ran.code == 0, ran.err
    told = json.loads(ran.out)
    assert [point["name"] for point in told["control_points"]] == list(session.points.names)
    assert told["warnings"][: len(session.notes)] == entry["read"]["notes"]
    for note in session.notes:
        assert f"neuralmls: warning: {note}\n" in ran.err
    same = session if session.weights == "inverse-distance" else session.replace(weights="inverse-distance")
    expected = same.fit(nm.read("cloud.npy")).deform(nm.read("cloud.npy"))
    assert np.array_equal(nm.read("out.npy").positions, expected)


@pytest.mark.parametrize("entry", BROKEN, ids=name_of)
def test_every_broken_file_is_one_sentence(run, here, entry):
    ran = run("deform", "shape.obj", *options(entry), "-o", "out.obj")
    assert ran.code == {"file": 1, "control point": 1, "argument": 2}[entry["error"]["kind"]]
    assert ran.out == ""
    assert ran.err.count("\n") == 1
    assert ran.err.startswith("neuralmls: error: ")
    assert not (here / "out.obj").exists()


def test_what_a_second_file_leaves_out_is_said_by_fit_and_with_a_map_too(run, here):
    (here / "where.csv").write_text("name,x,y,z\nfoot,0.5,0,0.5\ntop,0.5,3,0.5\nnose,1,1,1\nside,1,1,0.5\n")
    both = ("--points", "points.csv", "--targets", "where.csv")
    fitted = run("fit", "shape.obj", *both, "-o", "shape.map", *CLASSIC)
    told = json.loads(run("deform", "shape.obj", *both, "-o", "a.obj", "--json", *CLASSIC).out)
    by_map = json.loads(run("deform", "shape.obj", "--map", "shape.map", *both, "-o", "b.obj", "--json").out)
    [note] = told["warnings"]
    assert "'nose'" in note
    assert by_map["warnings"] == [note]
    assert fitted.err == f"neuralmls: warning: {note}\n"
    assert {point["name"]: point["moved"] for point in told["control_points"]} == {"foot": 0, "side": 0, "top": 1}
    assert (here / "a.obj").read_bytes() == (here / "b.obj").read_bytes()


def test_targets_without_sources_and_an_order_of_nothing_are_refused(refused, here):
    refused(2, "deform", "shape.obj", "--targets", "points.csv", "-o", "o.obj", words=("--points",))
    words = ("--by-order", "--targets")
    refused(2, "deform", "shape.obj", "--points", "points.csv", "--by-order", "-o", "o.obj", words=words)
    refused(
        1, "deform", "shape.obj", "--points", "points.csv", "--targets", "none.csv", "-o", "o.obj", words=("none.csv",)
    )
