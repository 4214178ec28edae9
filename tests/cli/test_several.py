"""`neuralmls deform` of several shapes, into folders, and through standard input."""

from __future__ import annotations

import json
import subprocess

import numpy as np
import pytest

import neuralmls as nm

CLASSIC = ("--weights", "inverse-distance")
OPTIONS = ("--points", "points.csv", "--move", "top=0,1,0", *CLASSIC)


@pytest.fixture
def cloud(here):
    """A cloud that begins with the vertices of shape.obj."""
    further = np.random.default_rng(0).uniform(-2, 2, (50, 3))
    np.save("cloud.npy", np.concatenate([nm.read("shape.obj").positions, further]))


def test_several_shapes_are_bent_by_one_map(run, here, cloud):
    ran = run("deform", "shape.obj", "cloud.npy", *OPTIONS, "-o", "new/out", "--json")
    assert (ran.code, ran.err) == (0, "")
    shape, points = nm.read("new/out/shape.obj").positions, nm.read("new/out/cloud.npy").positions
    np.testing.assert_allclose(points[: len(shape)], shape, rtol=0, atol=1e-6)
    results = json.loads(ran.out)["results"]
    assert [told["output"] for told in results] == ["new/out/shape.obj", "new/out/cloud.npy"]
    sources = nm.Session(nm.ControlPoints.read("points.csv").moved({"top": [0, 1, 0]}), weights="inverse-distance")
    expected = sources.fit(nm.read("shape.obj"), nm.read("cloud.npy")).at(nm.read("cloud.npy").positions)
    assert np.array_equal(points, expected)


def test_control_points_are_judged_by_all_shapes_together(run, here):
    (here / "badge.xyz").write_text("0.5 1.9 0.5\n0.6 1.9 0.5\n0.5 1.95 0.5\n")
    assert "outside of the shape" in run("deform", "badge.xyz", *OPTIONS, "-o", "alone.xyz").err
    assert run("deform", "shape.obj", "badge.xyz", *OPTIONS, "-o", "out").err == ""


def test_people_read_of_each(run, here, cloud):
    out = run("deform", "shape.obj", "cloud.npy", *OPTIONS, "-o", "out/").out
    assert "shape.obj -> out/shape.obj\n" in out
    assert "cloud.npy -> out/cloud.npy\n" in out


@pytest.mark.parametrize(
    ("name", "text", "words"),
    [
        ("broken.obj", "v 1 2\n", "broken.obj: line 1"),
        ("missing.obj", None, "missing.obj: there is no such file"),
        ("flat.xyz", "0 0\n1 1\n0 1\n", "points.csv, for flat.xyz: "),
        ("one.xyz", "1 1 1\n", "one.xyz: there is only one vertex"),
    ],
)
def test_one_that_fails_does_not_stop_the_others(run, here, cloud, name, text, words):
    if text is not None:
        (here / name).write_text(text)
    ran = run("deform", "shape.obj", name, "cloud.npy", *OPTIONS, "-o", "out", "--json")
    assert ran.code == 1
    assert ran.err.count("\n") == 1
    assert ran.err.startswith(f"neuralmls: error: {words}")
    assert [told["input"] for told in json.loads(ran.out)["results"]] == ["shape.obj", "cloud.npy"]
    assert sorted(path.name for path in (here / "out").iterdir()) == ["cloud.npy", "shape.obj"]


def test_one_that_cannot_be_written_does_not_stop_the_others(run, here, cloud):
    (here / "tiny.ply").write_text(
        "ply\nformat ascii 1.0\nelement vertex 2\nproperty char x\nproperty char y\nproperty char z\nend_header\n"
        "0 0 0\n1 120 1\n"
    )
    moved = ("--points", "points.csv", "--move", "top=0,1000,0", *CLASSIC)
    ran = run("deform", "tiny.ply", "shape.obj", *moved, "-o", "out", "-q")
    assert ran.code == 1
    assert ran.err.endswith("is beyond the range of the file's int8\n")
    assert "neuralmls: error: tiny.ply: vertex " in ran.err
    assert [path.name for path in (here / "out").iterdir()] == ["shape.obj"]


def test_where_all_fail_each_is_said_and_nothing_is_left(run, content):
    before = content()
    ran = run("deform", "a.obj", "b.obj", *OPTIONS, "-o", "out", "--json")
    assert (ran.code, ran.out) == (1, "")
    assert [line.split(": ")[2] for line in ran.err.splitlines()] == ["a.obj", "b.obj"]
    assert content() == before


def test_two_shapes_of_one_name_are_refused(refused, here):
    (here / "more").mkdir()
    (here / "more" / "shape.obj").write_text((here / "shape.obj").read_text())
    words = ("out: two shapes are called 'shape.obj'",)
    refused(2, "deform", "shape.obj", "more/shape.obj", *OPTIONS, "-o", "out", words=words)


def test_what_is_there_is_refused_before_any_work(refused, run, here, cloud):
    (here / "out").mkdir()
    (here / "out" / "cloud.npy").write_text("precious")
    several = ("deform", "shape.obj", "cloud.npy", *OPTIONS)
    refused(2, *several, "-o", "out", words=("out/cloud.npy", "--force"))
    refused(2, *several, "-o", ".", words=("the input itself",))
    refused(2, *several, "-o", "-", words=("standard output takes one file",))
    refused(2, *several, "-o", "both.obj", words=("both.obj: expected a folder for 2 shapes",))
    refused(1, *several, "-o", "points.csv", words=("points.csv",))
    assert run(*several, "-o", "out", "--force", "-q").code == 0


def test_one_shape_goes_into_a_folder_that_is_there_or_ends_as_one(run, here):
    (here / "there").mkdir()
    for folder in ("there", "new/"):
        assert run("deform", "shape.obj", *OPTIONS, "-o", folder, "-q").code == 0
    assert (here / "there" / "shape.obj").read_bytes() == (here / "new" / "shape.obj").read_bytes()


@pytest.mark.parametrize("name", ["shape.obj", "cloud.npy"])
def test_a_shape_comes_from_standard_input(process, run, here, cloud, name):
    assert run("deform", name, *OPTIONS, "-o", f"out-{name}", "-q").code == 0
    with open(name, "rb") as file:
        ran = process("deform", "-", *OPTIONS, "-o", "-", "-q", stdin=file)
    assert (ran.code, ran.err) == (0, b"")
    assert ran.out == (here / f"out-{name}").read_bytes()


def test_control_points_come_from_standard_input(process, run, here):
    nm.Session(nm.ControlPoints.read("points.csv").moved({"top": [0, 1, 0]}), weights="inverse-distance").write(
        "s.json"
    )
    assert run("deform", "shape.obj", "--points", "s.json", "-o", "out.obj", "-q").code == 0
    with open("s.json", "rb") as file:
        ran = process("deform", "shape.obj", "--points", "-", "-o", "-", "-q", stdin=file)
    assert (ran.code, ran.out, ran.err) == (0, (here / "out.obj").read_bytes(), b"")


@pytest.mark.parametrize(
    ("arguments", "text", "words"),
    [
        (("-", "--points", "points.csv", "-o", "out.obj"), b"v 1 2\n", b"standard input: "),
        (("-", "--points", "points.csv", "-o", "out.obj"), b"", b"standard input: "),
        (("shape.obj", "--points", "-", "-o", "out.obj"), b"name,x,y,z\na,1\n", b"standard input: line 2"),
        (("-", "--points", "-", "-o", "out.obj"), b"", b"standard input holds one file"),
        (("shape.obj", "--points", "-", "--targets", "-", "-o", "out.obj"), b"", b"standard input holds one file"),
        (("-", "--points", "points.csv", "-o", "out/"), b"", b"what comes from standard input has no name"),
    ],
)
def test_what_standard_input_cannot_be_is_one_sentence(start, here, content, arguments, text, words):
    before = content()
    with start("deform", *arguments, stdin=subprocess.PIPE) as running:
        out, err = running.communicate(text, timeout=60)
    assert running.returncode in (1, 2)
    assert (out, err.count(b"\n")) == (b"", 1)
    assert err.startswith(b"neuralmls: error: ")
    assert words in err
    assert content() == before
