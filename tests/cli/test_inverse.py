"""`neuralmls deform --inverse`: what was deformed comes back."""

from __future__ import annotations

import numpy as np
import pytest

import neuralmls as nm

MOVED = ("--move", "top=0.1,0.1,0")


def close(a: str, b: str) -> bool:
    return bool(np.abs(nm.read(a).positions - nm.read(b).positions).max() < 5e-6)


@pytest.mark.parametrize("options", [("--width", "64"), ("--weights", "inverse-distance", "--transform", "affine")])
def test_a_map_is_undone(run, here, options):
    fit = ("fit", "shape.obj", "--points", "points.csv", "-o", "shape.map", *options)
    assert run(*fit).code == 0
    assert run("deform", "shape.obj", "--map", "shape.map", *MOVED, "-o", "bent.obj").code == 0
    ran = run("deform", "bent.obj", "--map", "shape.map", *MOVED, "--inverse", "--check", "-o", "back.obj")
    assert (ran.code, ran.err) == (0, "")
    assert close("back.obj", "shape.obj")
    assert not close("bent.obj", "shape.obj")


def test_without_a_map_weights_that_hang_on_nothing_else_are_undone(run, here):
    given = ("--points", "points.csv", *MOVED, "--weights", "inverse-distance")
    assert run("deform", "shape.obj", *given, "-o", "bent.obj").code == 0
    assert run("deform", "bent.obj", *given, "--inverse", "-o", "back.obj").code == 0
    assert close("back.obj", "shape.obj")


@pytest.mark.parametrize(
    "options", [(), ("--weights", "shape-aware"), ("--weights", "inverse-distance", "--epsilon", "1")]
)
def test_others_are_refused_and_nothing_is_written(run, here, options):
    ran = run("deform", "shape.obj", "--points", "points.csv", *MOVED, *options, "--inverse", "-o", "back.obj")
    assert ran.code == 2
    assert "--inverse: the weights hang on the shape at rest" in ran.err
    assert "--map" in ran.err
    assert not (here / "back.obj").exists()


def test_a_frame_says_enough(run, here):
    points = nm.ControlPoints.read("points.csv").moved({"top": [0.1, 0.1, 0]})
    nm.Session(points, width=64, frame=[[0, 0, 0], [1, 2, 1.5]]).write("framed.json")
    assert run("deform", "shape.obj", "--points", "framed.json", "-o", "bent.obj").code == 0
    assert run("deform", "bent.obj", "--points", "framed.json", "--inverse", "-o", "back.obj").code == 0
    assert close("back.obj", "shape.obj")


def test_unmoved_control_points_give_the_very_bytes(run, here):
    given = ("--points", "points.csv", "--weights", "inverse-distance")
    assert run("deform", "shape.obj", *given, "--inverse", "-o", "back.obj").code == 0
    assert (here / "back.obj").read_bytes() == (here / "shape.obj").read_bytes()


def test_where_no_place_was_found_nothing_is_written(run, here):
    given = ("--points", "points.csv", "--weights", "inverse-distance", "--transform", "affine")
    flat = [("--move", move) for move in ("top=0,-2,0", "side=0,-1,0")]
    ran = run("deform", "shape.obj", *given, *(word for pair in flat for word in pair), "--inverse", "-o", "back.obj")
    assert ran.code == 2
    assert "--inverse: shape.obj: points: no place was found that goes to " in ran.err
    assert not (here / "back.obj").exists()
