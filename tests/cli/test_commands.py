"""The other commands: inspect, points, render, sample, demo."""

from __future__ import annotations

import json
import sys

import numpy as np
import pytest

import neuralmls as nm


def test_inspect_tells_what_is_there(run):
    ran = run("inspect", "shape.obj")
    assert (ran.code, ran.err) == (0, "")
    for words in ("shape.obj: OBJ", "8", "(0, 0, 0) to (1, 2, 1.5)", "1 x 2 x 1.5", "lower, upper", "oak"):
        assert words in ran.out
    assert "Everything else is carried over" in ran.out
    assert "normals" not in ran.out


def test_inspect_says_that_normals_turn(run, here):
    (here / "n.obj").write_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nvn 0 0 1\nf 1//1 2//1 3//1\n")
    assert "normals and tangents turn with the surface" in run("inspect", "n.obj").out


def test_inspect_for_machines(run):
    told = json.loads(run("inspect", "shape.obj", "--json").out)
    assert (told["format"], told["vertices"], told["triangles"], told["dimension"]) == ("OBJ", 8, 4, 3)
    assert told["bounds"] == [[0, 0, 0], [1, 2, 1.5]]
    assert told["size"] == [1, 2, 1.5]
    assert told["turns_normals"] is False
    assert "oak" in told["holds"]["materials"]


@pytest.mark.parametrize("name", ["new.json", "new.csv"])
def test_points_are_named_placed_on_the_shape_and_the_same_for_the_same_seed(run, here, name):
    ran = run("points", "shape.obj", "--count", "5", "-o", name, "--seed", "4")
    assert (ran.code, ran.err) == (0, "")
    points = nm.ControlPoints.read(name)
    shape = nm.read("shape.obj")
    assert points.names == ("p1", "p2", "p3", "p4", "p5")
    np.testing.assert_array_equal(points.sources, points.targets)
    expected = nm.place(shape.positions, shape.faces, 5, seed=4).points
    np.testing.assert_array_equal(points.sources, expected.sources)
    first = (here / name).read_bytes()
    ran = run("points", "shape.obj", "--count", "5", "-o", name, "--seed", "4")
    assert (ran.code, "--force" in ran.err) == (2, True)
    assert run("points", "shape.obj", "--count", "5", "-o", name, "--seed", "4", "--force").code == 0
    assert (here / name).read_bytes() == first


def test_points_default_to_twelve_and_say_how_to_go_on(run):
    ran = run("points", "shape.obj", "-o", "new.json")
    assert len(nm.ControlPoints.read("new.json")) == 12
    tried = ran.out[ran.out.index("deform ") :].split()
    assert run(*tried).code == 0  # the command that it says to try


def test_points_in_pairs_and_as_many_as_make_a_difference(run, here):
    assert run("sample", "airplane", "-o", "plane.obj", "-q").code == 0
    told = json.loads(run("inspect", "plane.obj", "--json").out)
    assert told["symmetry"][0]["verdict"] == "symmetric"
    assert "by the plane across (1, 0, 0) at 0" in run("inspect", "plane.obj").out
    ran = run("points", "plane.obj", "-o", "pairs.json", "--symmetric", "--count", "auto")
    assert (ran.code, "of the size from the nearest" in ran.out) == (0, True)
    points = nm.ControlPoints.read("pairs.json")
    assert sum(twin is not None for twin in points.mirror_of) >= 2
    uneven = "v 0 0 0\nv 3 0 0\nv 0.4 1.9 0\nv 0.9 0.3 1.1\nf 1 2 3\nf 1 2 4\nf 2 3 4\nf 1 3 4\n"
    (here / "uneven.obj").write_text(uneven)
    ran = run("points", "uneven.obj", "-o", "none.json", "--symmetric")
    assert (ran.code, "not its own mirror image" in ran.err) == (2, True)
    ran = run("points", "shape.obj", "-o", "none.json", "--count", "some")
    assert (ran.code, "or auto, found some" in ran.err) == (2, True)


@pytest.mark.parametrize("name", ["chair", "airplane", "car", "table"])
def test_samples_are_written_with_what_belongs_to_them(run, here, name):
    ran = run("sample", name, "-o", f"my-{name}.obj")
    assert (ran.code, ran.err) == (0, "")
    for file in (f"my-{name}.obj", f"my-{name}.mtl", f"my-{name}.points.json"):
        assert (here / file).is_file()
        assert file in ran.out
    shape, points = nm.read(f"my-{name}.obj"), nm.ControlPoints.read(f"my-{name}.points.json")
    assert points.check(shape.bounds) == []
    assert (points.sources != points.targets).any()
    tried = ran.out[ran.out.index("deform ") :].split()
    assert run(*tried, "--weights", "inverse-distance").code == 0


def test_sample_refuses_to_overwrite_any_of_its_files(run, here):
    (here / "chair.points.json").write_text("mine")
    ran = run("sample", "chair", "-o", "chair.obj")
    assert (ran.code, "chair.points.json" in ran.err) == (2, True)
    assert not (here / "chair.obj").exists()


def test_demo_makes_everything_and_says_where(run, here):
    ran = run("demo")
    assert ran.code == 0
    names = ["chair.obj", "chair.mtl", "chair.points.json", "chair-neural.obj", "chair-classic.obj"]
    if "there is no picture" not in ran.err:  # without PyVista, or where it cannot draw
        assert ran.err == ""
        names.append("chair.png")
    assert sorted(path.name for path in (here / "out").iterdir()) == sorted(names)
    source, neural, classic = (
        nm.read(f"out/{name}.obj").positions for name in ("chair", "chair-neural", "chair-classic")
    )
    for bent in (neural, classic):  # longer legs
        assert bent[:, 1].min() < source[:, 1].min() - 0.1
    assert np.abs(neural - classic).max() > 0.01
    assert "out/chair-neural.obj" in ran.out
    refusal = run("demo")
    assert (refusal.code, "--force" in refusal.err) == (2, True)


def test_demo_goes_on_without_pyvista(run, here, monkeypatch):
    monkeypatch.setitem(sys.modules, "pyvista", None)  # as if it were not installed
    ran = run("demo", "-o", "deep/er")
    assert ran.code == 0
    assert ran.err.count("\n") == 1
    assert ran.err.startswith("neuralmls: warning: there is no picture: ")
    assert "neuralmls[figures]" in ran.err
    assert (here / "deep" / "er" / "chair-classic.obj").is_file()
    assert not (here / "deep" / "er" / "chair.png").exists()
    assert run("demo", "-o", "deep/er", "--force").code == 0


def test_render_without_pyvista_is_refused(refused, monkeypatch):
    monkeypatch.setitem(sys.modules, "pyvista", None)
    refused(1, "render", "shape.obj", "-o", "out.png", words=("neuralmls[figures]",))


def test_render_draws_shapes_points_and_weights(run, here):
    pytest.importorskip("pyvista", reason="figures need PyVista")
    image = pytest.importorskip("PIL.Image")
    points = ("--points", "points.csv")
    assert run("deform", "shape.obj", *points, "-o", "out.obj", "--move", "top=0,1,0", "-q").code == 0
    ran = run("render", "shape.obj", "out.obj", "-o", "out.png", *points, "--heat", "top")
    assert (ran.code, ran.out) == (0, "out.png: shape.obj, out.obj\n"), ran.err
    pixels = np.asarray(image.open(here / "out.png").convert("RGB")).astype(int)
    assert pixels.shape[1] == 1600
    left, right = pixels[:, :800], pixels[:, 800:]
    warm = [int((half[:, :, 0] > half[:, :, 2] + 60).sum()) for half in (left, right)]
    assert warm[0] > 10 * max(warm[1], 100)  # the heat map and the red balls are in the first panel only
