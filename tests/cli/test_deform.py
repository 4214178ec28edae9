"""`neuralmls deform` where all is well."""

from __future__ import annotations

import json
import os
import re

import numpy as np
import pytest

import neuralmls as nm

QUICK = ("--width", "32", "--steps", "20")
CLASSIC = ("--weights", "inverse-distance")
DEFORM = ("deform", "shape.obj", "--points", "points.csv")
SIX = "name,x,y,z\nfoot,0.5,0,0.5\nside,1,1,0.5\ntop,0.5,2,0.5\na,0,0,1.5\nb,1,2,0\nc,0,2,1.5\n"


@pytest.mark.parametrize("weights", [QUICK, CLASSIC])
def test_unmoved_control_points_give_the_very_bytes(run, here, weights):
    ran = run(*DEFORM, "-o", "out.obj", *weights)
    assert ran.code == 0
    assert (here / "out.obj").read_bytes() == (here / "shape.obj").read_bytes()
    assert ran.err == "neuralmls: warning: no control point is moved, so that the output is the input\n"


def test_only_positions_change(run, here):
    assert run(*DEFORM, "-o", "out.obj", *CLASSIC, "--move", "top=0,1,0").code == 0
    before = (here / "shape.obj").read_text().splitlines()
    after = (here / "out.obj").read_text().splitlines()
    assert len(after) == len(before)
    for old, new in zip(before, after, strict=True):
        assert old == new or (old.startswith("v ") and new.startswith("v "))
    assert sum(old != new for old, new in zip(before, after, strict=True)) >= 4


@pytest.mark.parametrize("transform", ["rigid", "similarity", "affine"])
@pytest.mark.parametrize("kind", ["neural", "inverse-distance"])
@pytest.mark.parametrize("handles", ["auto", "exact", "soft"])
def test_positions_are_those_of_the_package(run, here, kind, transform, handles):
    options = ("--weights", kind, *(QUICK if kind == "neural" else ("--alpha", "0.75", "--epsilon", "0.01")))
    moves = ("--move", "top=0.25,1,0", "--move", "side=0,0,-0.5")
    options += ("--transform", transform, "--temperature", "0.8", "--handles", handles)
    assert run(*DEFORM, "-o", "out.obj", *options, *moves).code == 0
    shape, points = nm.read("shape.obj"), nm.ControlPoints.read("points.csv")
    points = points.moved({"top": [0.25, 1, 0], "side": [0, 0, -0.5]})
    if kind == "neural":
        weights = nm.NeuralWeights.fit(points.sources, bounds=shape.bounds, width=32, steps=20)
    else:
        weights = nm.InverseDistanceWeights(points.sources, bounds=shape.bounds, alpha=0.75, epsilon=0.01)
    exact = nm.ExactHandles(weights, transform=transform)
    solve = exact.aim if handles == "exact" else exact.aim_carefully
    aim = solve(points.targets, 0.8, 0.0 if handles == "soft" else 1.0)
    expected = nm.Deformer(shape.positions, weights, transform=transform).deform(aim.targets, 0.8)
    np.testing.assert_allclose(nm.read("out.obj").positions, expected, rtol=0, atol=1e-6)


def test_moves_add_to_the_targets_of_the_file(run, here):
    text = "name,x,y,z,target_x,target_y,target_z\nfoot,0.5,0,0.5,0.5,0,0.5\ntop,0.5,2,0.5,0.5,3,0.5\n"
    (here / "moved.csv").write_text(text)
    points = ("--points", "moved.csv")
    ran = run("deform", "shape.obj", *points, "-o", "out.obj", *CLASSIC, "--move", "top=0,0.5,0", "--json")
    moved = {point["name"]: point["moved"] for point in json.loads(ran.out)["control_points"]}
    assert moved == {"foot": 0.0, "top": 1.5}


@pytest.mark.parametrize(("axis", "vector"), [("y", (0, 1, 0)), ("-1,2,0.5", (-1, 2, 0.5))])
def test_turns_are_those_of_the_package(run, here, axis, vector):
    turn = ("--turn", f"top={axis},70")
    ran = run(*DEFORM, "-o", "out.obj", *CLASSIC, *turn, "--move", "top=0.25,1,0", "--json")
    points = (
        nm.ControlPoints.read("points.csv").moved({"top": [0.25, 1, 0]}).oriented({"top": nm.Orientation(vector, 70)})
    )
    shape = nm.read("shape.obj")
    deformer = nm.Deformer(shape.positions, nm.InverseDistanceWeights(points.sources, bounds=shape.bounds))
    expected = deformer.deform(points.targets, rotations=points.rotations)
    assert np.abs(expected - deformer.deform(points.targets)).max() > 0.1
    np.testing.assert_allclose(nm.read("out.obj").positions, expected, rtol=0, atol=1e-6)
    told = {point["name"]: point for point in json.loads(ran.out)["control_points"]}
    assert told["top"]["oriented"] == 70
    assert told["top"]["degrees_to_rotation"] < 1e-3  # classic weights: its own place is all its own
    assert "oriented" not in told["foot"]


def test_a_turn_is_seen_in_the_summary_and_moves_what_nothing_else_moves(run, here):
    ran = run(*DEFORM, "-o", "out.obj", *CLASSIC, "--turn", "top=z,30", "--turn", "foot=x,0")
    assert ran.code == 0
    assert "2 turned" in ran.out
    assert "30 deg" in ran.out
    assert "the output is the input" not in ran.err
    assert (here / "out.obj").read_bytes() != (here / "shape.obj").read_bytes()


def test_turns_by_nothing_return_the_very_bytes(run, here):
    assert run(*DEFORM, "-o", "out.obj", *CLASSIC, "--turn", "top=z,0").code == 0
    assert (here / "out.obj").read_bytes() == (here / "shape.obj").read_bytes()


def test_a_turn_of_the_file_is_turned_further(run, here):
    points = nm.ControlPoints.read("points.csv").oriented({"top": nm.Orientation((0, 0, 1), 50)})
    points.write("turned.json")
    assert (
        run("deform", "shape.obj", "--points", "turned.json", "-o", "a.obj", *CLASSIC, "--turn", "top=z,-20").code == 0
    )
    assert run(*DEFORM, "-o", "b.obj", *CLASSIC, "--turn", "top=z,30").code == 0
    assert np.abs(nm.read("a.obj").positions - nm.read("b.obj").positions).max() < 1e-6


def test_names_may_hold_an_equals_sign(run, here):
    (here / "odd.csv").write_text("name,x,y,z\na=b,0,0,0\nc,0,2,0\n")
    ran = run("deform", "shape.obj", "--points", "odd.csv", "-o", "out.obj", *CLASSIC, "--move", "a=b=0,-1,0", "--json")
    assert [point["moved"] for point in json.loads(ran.out)["control_points"]] == [1.0, 0.0]


def test_json_and_csv_points_give_the_same(run, here):
    nm.ControlPoints.read("points.csv").write("points.json")
    for ending in ("csv", "json"):
        ran = run(
            "deform", "shape.obj", "--points", f"points.{ending}", "-o", f"{ending}.obj", "--move", "top=1,0,0", *QUICK
        )
        assert ran.code == 0
    assert (here / "csv.obj").read_bytes() == (here / "json.obj").read_bytes()


def test_same_seed_gives_the_same_bytes_and_another_one_others(run, here):
    for name, seed in (("a", "7"), ("b", "7"), ("c", "8")):
        assert run(*DEFORM, "-o", f"{name}.obj", "--move", "top=1,0,0", *QUICK, "--seed", seed).code == 0
    a, b, c = ((here / f"{name}.obj").read_bytes() for name in "abc")
    assert a == b
    assert a != c


def test_summary_for_machines(run):
    ran = run(*DEFORM, "-o", "out.obj", *QUICK, "--seed", "3", "--move", "top=0,1,0", "--json", "--temperature", "1.5")
    told = json.loads(ran.out)
    assert ran.err == ""
    assert told["input"] == "shape.obj"
    assert told["output"] == "out.obj"
    assert told["files"] == ["out.obj"]
    assert (told["format"], told["vertices"], told["triangles"], told["longest_side"]) == ("OBJ", 8, 4, 2.0)
    assert told["weights"]["kind"] == "neural"
    assert told["weights"]["steps"] == 20
    assert told["weights"]["seed"] == 3
    assert told["weights"]["loss"] > 0
    assert (told["transform"], told["temperature"]) == ("rigid", 1.5)
    assert [point["name"] for point in told["control_points"]] == ["foot", "side", "top"]
    assert list(told["seconds"]) == ["read", "train", "bind", "move", "write"]
    assert told["warnings"] == []


def test_distances_to_targets_are_where_the_control_points_arrive(run):
    """Classic weights meet every target; a network after few steps does not, and is said not to."""
    exact = json.loads(run(*DEFORM, "-o", "a.obj", *CLASSIC, "--move", "top=0,1,0", "--json").out)
    assert max(point["distance_to_target"] for point in exact["control_points"]) < 1e-6
    short = json.loads(
        run(*DEFORM, "-o", "b.obj", "--steps", "1", "--handles", "soft", "--move", "top=0,1,0", "--json").out
    )
    points = nm.ControlPoints.read("points.csv").moved({"top": [0, 1, 0]})
    weights = nm.NeuralWeights.fit(points.sources, bounds=nm.read("shape.obj").bounds, steps=1)
    arrived = nm.Deformer(points.sources, weights).deform(points.targets)
    expected = np.linalg.norm(arrived - points.targets, axis=1)
    assert expected.max() > 0.1
    found = [point["distance_to_target"] for point in short["control_points"]]
    np.testing.assert_allclose(found, expected, atol=1e-6)


def test_summary_for_people(run):
    ran = run(*DEFORM, "-o", "out.obj", *QUICK, "--move", "top=0,1,0")
    assert ran.err == ""
    lines = ran.out.splitlines()
    assert lines[0] == "shape.obj -> out.obj"
    assert max(map(len, lines)) <= 80
    for words in (
        "8, in 4 triangles",
        "3, 1 of them moved",
        "neural, loss",
        "after 20 steps, seed 0",
        "rigid, temperature 1",
    ):
        assert words in ran.out
    for stage in ("read ", "train ", "bind ", "move ", "write ", "in all"):
        assert stage in ran.out
    top = next(line for line in lines if line.startswith("  top")).split()
    assert top[1] == "1.0000"
    assert top[-1] == "%"


def test_control_points_that_the_training_cannot_part_are_named(run, here):
    (here / "near.csv").write_text("name,x,y,z\nseat,0,0.5,0\nseat-too,0,0.5,1e-13\nfoot,0,-0.5,0\nside,1,0.5,0\n")
    ran = run("deform", "shape.obj", "--points", "near.csv", "-o", "a.obj", "--move", "seat=0,0.1,0", "--width", 64)
    assert ran.code == 0
    assert ran.err.count("\n") == 1
    assert ran.err.startswith("neuralmls: warning: after 2,000 steps of training, control points still share")
    assert "'seat'" in ran.err
    assert "'seat-too'" in ran.err
    assert "'foot'" not in ran.err


def test_many_control_points_are_listed_when_asked_for(run, here):
    lines = [f"p{i},{i / 30},{i / 20},0" for i in range(30)]
    (here / "many.csv").write_text("\n".join(["name,x,y,z", *lines]) + "\n")
    many = ("deform", "shape.obj", "--points", "many.csv", *CLASSIC, "--move", "p3=0,0.5,0")
    short, long = run(*many, "-o", "a.obj").out, run(*many, "-o", "b.obj", "--verbose").out
    assert "--verbose shows all 30" in short
    assert long.count("\n  p") == 30
    assert short.count("\n  p") == 20


def test_quiet_says_nothing(run, here):
    ran = run(*DEFORM, "-o", "out.obj", *CLASSIC, "--move", "top=0,1,0", "-q")
    assert (ran.code, ran.out, ran.err) == (0, "", "")
    assert (here / "out.obj").is_file()


def test_standard_output_gets_the_file_and_nothing_else(process, here):
    moved = (*DEFORM, *CLASSIC, "--move", "top=0,1,0")
    assert process(*moved, "-o", "out.obj").code == 0
    done = process(*moved, "-o", "-")
    assert done.code == 0
    assert done.out == (here / "out.obj").read_bytes()
    assert b"3, 1 of them moved" in done.err
    told = process(*moved, "-o", "-", "--json")
    assert told.out == done.out
    assert json.loads(told.err)["output"] == "-"


def test_binary_files_go_through_standard_output(process, here):
    cloud = np.random.default_rng(0).uniform(-1, 1, (50, 3))
    np.save("cloud.npy", cloud)
    done = process("deform", "cloud.npy", "--points", "points.csv", "-o", "-", *CLASSIC, "-q")
    assert done.out == (here / "cloud.npy").read_bytes()


def test_real_process_ends_with_zero_and_no_word_on_standard_error(process, here):
    done = process(*DEFORM, "-o", "out.obj", *CLASSIC, "--move", "top=0,1,0")
    assert (done.code, done.err) == (0, b"")
    assert sorted(os.listdir(here)) == ["out.obj", "points.csv", "shape.obj"]


def test_gltf_buffers_are_called_after_the_output(run, here, data):
    original = data / "manufactured" / "kaykit_furniture"
    for name in ("chair_A.gltf", "chair_A.bin"):
        (here / name).write_bytes((original / name).read_bytes())
    buffer = (here / "chair_A.bin").read_bytes()
    gltf = ("deform", "chair_A.gltf", "--points", "p.json", *CLASSIC, "--move", "p1=0,0.2,0")
    assert run("points", "chair_A.gltf", "-o", "p.json").code == 0
    ran = run(*gltf, "-o", "bent.gltf", "--json")
    assert ran.code == 0, ran.err
    assert json.loads(ran.out)["files"] == ["bent.gltf", "bent.bin"]
    assert (here / "chair_A.bin").read_bytes() == buffer
    moved = nm.read("bent.gltf").positions - nm.read("chair_A.gltf").positions
    assert np.abs(moved).max() > 0.05
    (here / "bent.gltf").unlink()
    # More steps than anybody waits for: it is refused before the training.
    ran = run(*gltf[:4], "--move", "p1=0,0.2,0", "--steps", "1000000", "-o", "bent.gltf")
    assert ran.code == 2
    assert ran.err == "neuralmls: error: bent.bin: there is such a file already; --force overwrites it\n"
    assert not (here / "bent.gltf").exists()
    ran = run(*gltf[:4], "--move", "p1=0,0.2,0", "--steps", "1000000", "-o", "-")
    assert ran.code == 2
    assert "chair_A.bin" in ran.err


@pytest.mark.parametrize(
    "name", ["shapenet/ShapeNetChair1/model.obj", "manufactured/oakChair/oakChair.obj", "botsch_sorkine/bar.off"]
)
def test_real_shapes_from_placement_to_result(run, data, name):
    shape = data / name
    output = f"out{shape.suffix}"
    assert run("points", shape, "-o", "p.csv", "--count", "8").code == 0
    same = run("deform", shape, "--points", "p.csv", "-o", output, "-q")
    assert same.code == 0
    with open(output, "rb") as file:
        assert file.read() == shape.read_bytes()
    step = float(np.ptp(nm.read(shape).positions, axis=0).max()) / 5
    told = run("deform", shape, "--points", "p.csv", "-o", output, "--force", "--move", f"p1=0,{step},0", "--json")
    points = json.loads(told.out)["control_points"]
    assert points[0]["moved"] == pytest.approx(step)
    # A network stops when each control point has 0.9 of the weight at its place: nearly there.
    assert max(point["distance_to_target"] for point in points) < 0.2 * step
    assert len(nm.read(output).positions) == len(nm.read(shape).positions)


def test_control_points_arrive_unless_they_are_to_be_soft(run, here):
    moved = (*DEFORM, "--width", "128", "--move", "top=0,0.5,0.2")
    soft = json.loads(run(*moved, "-o", "soft.obj", "--json", "--handles", "soft").out)
    ran = run(*moved, "-o", "plain.obj", "--json")
    assert ran.err == ""
    plain = json.loads(ran.out)
    said = run(*moved, "-o", "exact.obj", "--handles", "exact").out
    assert [(told["handles"], told["arrival"], told["soft"]) for told in (soft, plain)] == [
        ("soft", "soft", None),
        ("auto", "exact", None),
    ]
    assert max(point["distance_to_target"] for point in soft["control_points"]) > 0.01
    assert max(point["distance_to_target"] for point in plain["control_points"]) < 1e-6
    assert (here / "plain.obj").read_bytes() == (here / "exact.obj").read_bytes()
    assert (here / "plain.obj").read_bytes() != (here / "soft.obj").read_bytes()
    assert re.search(r"handles +exact\n", said)


def test_what_is_relaxed_arrives_elsewhere_by_the_part_that_is_set(run, here):
    moved = ("deform", "shape.obj", "--points", "points.csv", *CLASSIC, "--move", "top=0.4,0.5,0")
    ran = {relax: run(*moved, "-o", f"{relax}.obj", "--relax", relax) for relax in ("0", "0.25", "1")}
    assert all((one.code, one.err) == (0, "") for one in ran.values())
    assert "temperature 1, relax 0.25\n" in ran["0.25"].out
    assert "relax" not in ran["0"].out
    plain, part, full = (nm.read(f"{relax}.obj").positions for relax in ran)
    assert np.abs(full - plain).max() > 0.01
    np.testing.assert_allclose(part, plain + 0.25 * (full - plain), rtol=0, atol=1e-6)


def test_control_points_that_own_little_are_left_soft_with_what_would_help(run, here):
    (here / "six.csv").write_text(SIX)
    moved = ("deform", "shape.obj", "--points", "six.csv", "--width", "128", "--move", "top=0,0.5,0.2", "--temperature")
    soft = run(*moved, "30", "-o", "soft.obj", "--handles", "soft")
    ran = run(*moved, "30", "-o", "plain.obj")
    assert (ran.code, ran.err) == (0, "")
    assert (here / "plain.obj").read_bytes() == (here / "soft.obj").read_bytes()
    assert max(map(len, ran.out.splitlines())) <= 80
    told = json.loads(run(*moved, "30", "-o", "plain.obj", "--json", "--force").out)
    assert (told["handles"], told["arrival"]) == ("auto", "left soft")
    assert re.fullmatch(r"'\w+' has only 0\.\d+ of the weight at its own place.*", told["soft"])
    for line in ("left soft:", *told["soft"].split("; ")):
        assert line in ran.out
    assert "left soft" not in soft.out
    # What it says would help does.
    told = json.loads(run(*moved, "10", "-o", "warm.obj", "--json").out)
    assert told["arrival"] == "left soft"
    assert told["soft"].endswith("; at temperature 5 they arrive")
    assert json.loads(run(*moved, "5", "-o", "cool.obj", "--json").out)["arrival"] == "exact"


def test_control_points_that_cannot_arrive_go_as_far_as_they_can(run, here):
    (here / "six.csv").write_text(SIX)
    moved = ("deform", "shape.obj", "--points", "six.csv", "--width", "128", "--move", "a=0,3,0", "--json")
    soft = json.loads(run(*moved, "--temperature", "2", "-o", "soft.obj", "--handles", "soft").out)
    ran = run(*moved, "--temperature", "2", "-o", "far.obj")
    told = json.loads(ran.out)
    assert (told["arrival"], told["soft"]) == ("as far as they go", None)
    stays, stayed = ([point["distance_to_target"] for point in way["control_points"]] for way in (told, soft))
    assert 0.01 < max(stays) < 0.5 * max(stayed)
    assert "control points do not arrive exactly: 'a' by " in ran.err
    # What it says would help does.
    assert ran.err.endswith(" under this transform: at temperature 1 they arrive\n")
    assert run(*moved, "--temperature", "1", "-o", "there.obj").err == ""


def test_exact_control_points_that_cannot_arrive_are_named(run, here):
    (here / "torn.csv").write_text(
        "name,x,y,z,target_x,target_y,target_z\na,0,0,0,0,0,0\nb,0.01,0,0,3,0,0\nc,0,2,0,0,2,0\nd,1,2,1.5,1,2,1.5\n"
    )
    torn = ("deform", "shape.obj", "--points", "torn.csv", *QUICK)
    ran = run(*torn, "-o", "out.obj", "--handles", "exact")
    assert ran.code == 0
    assert "control points do not arrive exactly: 'b' by" in ran.err or "'a' by" in ran.err
    assert "affine transform" in ran.err
    # Unless one insists they are left soft.
    assert json.loads(run(*torn, "-o", "plain.obj", "--json").out)["arrival"] == "left soft"
    assert run(*torn, "-o", "soft.obj", "--handles", "soft").err == ""
    assert (here / "plain.obj").read_bytes() == (here / "soft.obj").read_bytes()
    assert (here / "plain.obj").read_bytes() != (here / "out.obj").read_bytes()


def test_check_says_what_is_likely_bad_and_ends_with_0(run, here):
    (here / "pair.csv").write_text("name,x,y,z\nfoot,0.5,0,0.5\nleft,0,2,0.75\nright,1,2,0.75\n")
    moves = ("--move", "left=1.5,0,0", "--move", "right=-1.5,1,0")
    command = ("deform", "shape.obj", "--points", "pair.csv", *QUICK, *moves)
    plain = run(*command, "-o", "a.obj", "--json")
    assert (plain.code, plain.err, "advice" in json.loads(plain.out)) == (0, "", False)
    ran = run(*command, "-o", "b.obj", "--json", "--check")
    assert ran.code == 0
    told = json.loads(ran.out)
    assert "misses" in [advice["kind"] for advice in told["advice"]]
    assert ran.err.splitlines() == [f"neuralmls: warning: {advice['sentence']}" for advice in told["advice"]]
    assert set(told["advice"][0]) == {"kind", "sentence", "where", "control_points", "amount"}
    assert "check" in told["seconds"]
    assert (here / "a.obj").read_bytes() == (here / "b.obj").read_bytes()


def test_check_is_silent_where_all_is_well(run):
    for move in ("top=0,0,0.05", "top=0,0,0"):
        ran = run(*DEFORM, "-o", "out.obj", "--width", "128", "--move", move, "--check", "--json", "--force")
        assert json.loads(ran.out)["advice"] == []


def test_check_tells_once_of_exact_control_points_that_cannot_arrive(run, here):
    (here / "torn.csv").write_text(
        "name,x,y,z,target_x,target_y,target_z\na,0,0,0,0,0,0\nb,0.01,0,0,3,0,0\nc,0,2,0,0,2,0\nd,1,2,1.5,1,2,1.5\n"
    )
    ran = run("deform", "shape.obj", "--points", "torn.csv", "-o", "out.obj", *QUICK, "--handles", "exact", "--check")
    assert ran.code == 0
    assert "stop short of their targets, with exact handles: " in ran.err
    assert "do not arrive exactly" not in ran.err


def test_a_group_moves_and_turns_by_its_name_and_what_is_locked_is_named(run, here):
    points = nm.ControlPoints.read(here / "points.csv").with_locked(["foot"]).grouped(["side", "top"], "upper")
    points.write(here / "held.json")
    held = ("deform", "shape.obj", "--points", "held.json", *CLASSIC)
    ran = run(*held, "-o", "out.obj", "--move", "upper=0,1,0", "--turn", "upper=y,90", "--move", "foot=1,0,0", "--json")
    told = json.loads(ran.out)
    assert [point["name"] for point in told["control_points"] if point["moved"] == 0] == ["foot"]
    assert max(point["distance_to_target"] for point in told["control_points"]) < 1e-6
    assert "the targets and rotations of 'foot' are not used" in ran.err
    upper = points.moved({"upper": [0, 1, 0], "foot": [1, 0, 0]}).oriented({"upper": nm.Orientation((0, 1, 0), 90)})
    shape = nm.read("shape.obj")
    expected = nm.Session(upper, weights="inverse-distance").fit(shape).at(shape.positions)
    assert np.abs(nm.read("out.obj").positions - expected).max() < 1e-6
