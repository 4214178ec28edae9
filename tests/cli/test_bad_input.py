"""Bad input: one sentence, exit code 2 for wrong use and 1 for bad data, nothing written."""

from __future__ import annotations

import os

import pytest

PLY = "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\nend_header\n"
HEADER = "name,x,y,z\n"


@pytest.mark.parametrize(
    ("name", "text", "words"),
    [
        ("empty.obj", "", ("empty.obj", "empty")),
        ("truncated.ply", PLY + "0 0 0\n1 1", ("truncated.ply", "2 rows")),
        ("truncated.obj", "v 0 0 0\nv 1 0 0\nv 1 1", ("line 3",)),
        ("really-a-ply.obj", PLY + "0 0 0\n1 1 1\n", ("PLY", "OBJ")),
        ("unknown.docx", "hello", (".docx",)),
        ("no-vertices.obj", "o nothing\n", ("no vertices",)),
        ("nan.obj", "v 0 0 0\nv 0 nan 0\n", ("line 2", "nan")),
        ("infinite.obj", "v 0 0 0\nv 0 1e999 0\n", ("line 2", "1e999")),
        ("comma.obj", "v 0,5 0 0\nv 1 0 0\n", ("line 1", "decimal commas are not read", "0,5")),
        ("comma.xyz", "0,5 0 0\n1 0 0\n", ("line 1", "decimal commas are not read", "0,5")),
        ("power.obj", f"v {10**400} 0 0\nv 1 0 0\n", ("line 1", "not a finite number")),
        (
            "pointer.ply",
            "version https://git-lfs.github.com/spec/v1\noid sha256:0\n",
            ("Git LFS pointer", "git lfs pull"),
        ),
        ("scene.dae", "<?xml version='1.0'?><COLLADA/>", ("COLLADA", "not read yet")),
        ("face.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 7\n", ("line 4", "7", "3")),
        ("one-place.obj", "v 1 1 1\nv 1 1 1\n", ("all 2 vertices", "one place")),
        ("huge.obj", "v -1e308 0 0\nv 1e308 0 0\nv 0 1 0\nf 1 2 3\n", ("1e+150 units",)),
        ("one.xyz", "0 0 0\n", ("only one vertex",)),
    ],
)
def test_bad_shapes(refused, here, name, text, words):
    (here / name).write_text(text)
    output = "out" + name[name.rindex(".") :]
    refused(1, "deform", name, "--points", "points.csv", "-o", output, words=(name, *words))
    if "place" not in name and name != "one.xyz":  # which hold enough to be looked at
        refused(1, "inspect", name, words=(name, *words))
    refused(1, "points", name, "-o", "new.json", words=(name, *words))


def test_missing_shape(refused):
    refused(
        1, "deform", "none.obj", "--points", "points.csv", "-o", "out.obj", words=("none.obj", "there is no such file")
    )
    refused(1, "inspect", "none.obj", words=("none.obj", "there is no such file"))


def test_folder_as_shape(refused, here):
    (here / "folder.obj").mkdir()
    refused(1, "deform", "folder.obj", "--points", "points.csv", "-o", "out.obj", words=("folder.obj", "directory"))


@pytest.mark.parametrize(
    ("name", "text", "words"),
    [
        ("empty.csv", "", ("empty",)),
        ("none.csv", HEADER, ("no control points",)),
        ("none.json", '{"format": "neuralmls-control-points", "version": 1, "control_points": []}', ("at least one",)),
        ("broken.json", '{"format": ', ("line 1", "JSON")),
        ("twice.csv", HEADER + "a,0,0,0\nb,1,0,0\nc,0,0,0\n", ("'a' and 'c'", "same place")),
        ("infinite.csv", HEADER + "a,0,0,0\nb,inf,0,0\n", ("'b'", "not finite")),
        ("flat.csv", "name,x,y\na,0,0\nb,1,0\n", ("flat.csv, for shape.obj", "2 coordinates", "3")),
        ("names.csv", HEADER + "a,0,0,0\na,1,0,0\n", ("'a'", "more than one")),
        ("target.csv", "name,x,y,z,target_x\na,0,0,0,1\n", ("line 1", "target_y")),
        ("half.csv", "name,x,y,z,target_x,target_y,target_z\na,0,0,0,1,,2\n", ("line 2", "target_y", "'a'")),
        ("huge.csv", HEADER + "a,0,0,0\nb,1e300,0,0\n", ("huge.csv, for shape.obj", "the position of 'b'", "1e+150")),
        ("points.txt", "control points, some day\n", ("points.txt: line 1", "name,x,y,z", "control points")),
    ],
)
def test_bad_control_points(refused, here, name, text, words):
    (here / name).write_text(text)
    refused(1, "deform", "shape.obj", "--points", name, "-o", "out.obj", words=words)


def test_targets_beyond_all_measure(refused):
    words = ("the target of 'top'", "1e+150")
    refused(1, "deform", "shape.obj", "--points", "points.csv", "-o", "o.obj", "--move", "top=1e308,0,0", words=words)


def test_a_picture_of_what_is_beyond_all_measure(refused, here):
    (here / "huge.obj").write_text("v -1e308 0 0\nv 1e308 0 0\nv 0 1 0\nf 1 2 3\n")
    refused(1, "render", "huge.obj", "-o", "out.png", words=("huge.obj", "1e+150 units"))


@pytest.mark.skipif(not os.path.exists("/dev/zero"), reason="there is no /dev/zero")
def test_devices_without_an_end_are_not_read(refused):
    refused(1, "inspect", "/dev/zero", words=("/dev/zero: cannot read: this is a device, not a file",))


def test_missing_control_points(refused):
    words = ("none.json", "no such file")
    refused(1, "deform", "shape.obj", "--points", "none.json", "-o", "out.obj", words=words)


def test_control_points_far_away_are_named_in_a_warning(run, here):
    (here / "far.csv").write_text(HEADER + "foot,0.5,0,0.5\nlost,5000,0,0\ntop,0.5,2,0.5\n")
    ran = run("deform", "shape.obj", "--points", "far.csv", "-o", "out.obj", "--move", "top=0,1,0", "-q")
    assert ran.code == 0
    for line in ran.err.splitlines():
        assert line.startswith("neuralmls: warning: the ")
        assert "of 'lost' lies up to 4999 units outside" in line
    assert "the position of" in ran.err


CLASSIC = ("--weights", "inverse-distance")


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--temperature", "0"), ("temperature", "above 0", "0")),
        (("--temperature", "-1"), ("temperature", "-1")),
        (("--temperature", "nan"), ("temperature: expected a number above 0", "NaN")),
        ((*CLASSIC, "--alpha", "0"), ("alpha", "above 0")),
        ((*CLASSIC, "--alpha", "inf"), ("alpha: expected a number above 0", "Infinity")),
        ((*CLASSIC, "--epsilon", "-0.1"), ("epsilon", "at least 0", "-0.1")),
        (("--width", "0"), ("width", "1 to 16384")),
        (("--width", "1000000"), ("width", "1000000")),
        (("--steps", "0"), ("steps", "found 0")),
        (("--steps", "-5"), ("steps", "-5")),
        (("--seed", "-1"), ("seed", "-1")),
        (("--steps", "many"), ("--steps", " int", "deform --help")),
        (("--weights", "magic"), ("--weights", "'magic'", "inverse-distance")),
        (("--transform", "projective"), ("--transform", "'projective'", "similarity")),
        (("--alpha", "2"), ("alpha belongs to inverse-distance", "neural")),
        (("--epsilon", "2"), ("epsilon belongs to inverse-distance",)),
        ((*CLASSIC, "--width", "64"), ("width belongs to neural", "inverse-distance")),
        ((*CLASSIC, "--steps", "64"), ("steps belongs to neural",)),
        ((*CLASSIC, "--seed", "1"), ("seed belongs to neural",)),
        (("--move", "tpo=0,1,0"), ("'tpo'", "nearest name is 'top'")),
        (("--move", "top=0,1"), ("'top'", "3 finite numbers")),
        (("--move", "top=0,1,inf"), ("'top'", "finite")),
        (("--move", "top=1_0,0,0"), ("NAME=dx,dy,dz", "top=1_0,0,0")),
        (("--move", "top=up"), ("NAME=dx,dy,dz", "top=up")),
        (("--move", "0,1,0"), ("NAME=dx,dy,dz", "0,1,0")),
        (("--move", "top=0,1,0", "--move", "top=0,2,0"), ("'top'", "twice")),
        (("--turn", "tpo=y,40"), ("'tpo'", "nearest name is 'top'")),
        (("--turn", "top=40"), ("'top'", "about an axis")),
        (("--turn", "top=w,40"), ("NAME=AXIS,DEGREES", "top=w,40")),
        (("--turn", "top=0,1,40"), ("NAME=AXIS,DEGREES", "top=0,1,40")),
        (("--turn", "top=0,0,0,40"), ("axis", "not all 0")),
        (("--turn", "top=y,inf"), ("degrees", "finite")),
        (("--turn", "y,40"), ("NAME=AXIS,DEGREES", "y,40")),
        (("--turn", "top=y,40", "--turn", "top=y,50"), ("'top'", "twice")),
        (("--frobnicate",), ("--frobnicate", "deform --help")),
        (("too", "many"), ("out.obj: expected a folder for 3 shapes",)),
        (("--handles", "hard"), ("--handles", "auto, exact, soft or a number", "'hard'")),
        (("--handles", "1.5"), ("handles", "at most 1", "1.5")),
        (("--handles", "nan"), ("handles: expected auto, exact, soft or a number", "at most 1", "NaN")),
        (("--relax", "-0.1"), ("relax: expected a number of at least 0 and at most 1, found -0.1",)),
        (("--relax", "nan"), ("relax: expected a number", "at most 1", "NaN")),
        (("--relax", "much"), ("--relax", "deform --help")),
    ],
)
def test_wrong_options(refused, options, words):
    # Nothing is moved, of which a warning would be said if the options were looked at any later.
    refused(2, "deform", "shape.obj", "--points", "points.csv", "-o", "out.obj", *options, words=words)


def test_wrong_options_are_refused_before_anything_is_read(refused):
    arguments = ("none.obj", "--points", "points.csv", "--steps", "0")
    refused(2, "deform", *arguments, "-o", "out.obj", words=("steps",))
    refused(2, "render", *arguments, "-o", "out.png", words=("steps",))


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("deform", "shape.obj", "-o", "out.obj"), ("--points",)),
        (("deform", "shape.obj", "--points", "points.csv"), ("--output",)),
        (("deform",), ("SHAPE", "deform --help")),
        (("frob",), ("'frob'", "neuralmls --help")),
        (("sample", "char", "-o", "out.obj"), ("'char'", "'chair'")),
        (("sample", "chair", "-o", "out.ply"), ("out.ply", ".obj")),
        (("points", "shape.obj", "-o", "out.txt"), ("out.txt", ".json or .csv")),
        (("points", "shape.obj", "-o", "out.json", "--count", "0"), ("count", "0")),
        (("points", "shape.obj", "-o", "out.json", "--seed", "-1"), ("seed", "-1")),
        (("render", "shape.obj", "-o", "out.jpg"), ("out.jpg", ".png")),
        (("render", "shape.obj", "-o", "out.png", "--heat", "top"), ("--heat", "--points")),
        (("render", "shape.obj", "-o", "o.png", "--points", "points.csv", "--heat", "tip"), ("'tip'", "'top'")),
    ],
)
def test_wrong_use(refused, arguments, words):
    refused(2, *arguments, words=words)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="this system has no named pipes")
def test_pipes_are_not_waited_for(refused, here):
    os.mkfifo(here / "pipe.obj")
    refused(1, "inspect", "pipe.obj", words=("pipe.obj: cannot read: this is a pipe, not a file",))


@pytest.mark.parametrize(
    ("name", "shown"),
    [
        ("a\nb\x1b[31m.obj", r"a\nb\x1b[31m.obj"),
        ("a\u202ejbo.exe", r"a\u202ejbo.exe"),
        ("a\u2066b\ufeff.obj", r"a\u2066b\ufeff.obj"),
        ("a\u2028b\u2029.obj", r"a\u2028b\u2029.obj"),
        ("a\udcff.obj", r"a\udcff.obj"),
        ("M\u00fcll \u6905.obj", "M\u00fcll \u6905.obj"),
    ],
)
def test_what_drives_a_terminal_or_turns_its_writing_is_spelled_out(refused, name, shown):
    refused(1, "inspect", name, words=(shown,))
