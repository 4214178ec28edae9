"""`neuralmls compare` and `neuralmls benchmark poses`."""

from __future__ import annotations

import csv
import json

import numpy as np
import pytest

import neuralmls as nm
from neuralmls_research.experiments.methods import METHODS
from neuralmls_research.metrics import measure

MOVED = """\
name,x,y,z,target_x,target_y,target_z
foot,0.5,0,0.5,0.5,0,0.5
side,1,1,0.5,1,1,0.5
top,0.5,2,0.5,0.5,2.5,0.5
"""


@pytest.fixture
def moved(here):
    """Control points of shape.obj, one of them moved."""
    (here / "moved.csv").write_text(MOVED)
    return ("compare", "shape.obj", "--points", "moved.csv")


def test_table_names_every_method_or_why_it_does_not_apply(run, moved, here):
    pytest.importorskip("igl")
    with (here / "shape.obj").open("a") as file:  # one more part, without a control point
        file.write("v 0 4 0\nv 1 4 0\nv 1 4 1\nf -3 -2 -1\n")
    ran = run(*moved)
    assert (ran.code, ran.err) == (0, "")
    for word in ("NeuralMLS", "Classic MLS", "off targets", "curvature", "Dirichlet", "flipped", "seconds"):
        assert word in ran.out
    assert "Shape-aware, exact (ours)" in ran.out
    assert "(ours): not in the paper" in ran.out
    told = ran.out[ran.out.index("what does not apply") :].split()
    assert "ARAP needs a control point on each connected part" in " ".join(told)


def test_json_holds_every_figure(run, moved):
    told = json.loads(run(*moved, "--json").out)
    assert [method["name"] for method in told["methods"]] == list(METHODS)
    assert (told["vertices"], told["triangles"], told["unit"]) == (8, 4, 1.0)
    for method in told["methods"]:
        assert (method["measures"] is None) == (method["not_applicable"] is not None)
    classic = next(method for method in told["methods"] if method["name"] == "classic")["measures"]
    shape = nm.read("shape.obj")
    points = nm.ControlPoints.read("moved.csv")
    weights = nm.InverseDistanceWeights(points.sources, alpha=0.5)
    y = nm.Deformer(shape.positions, weights).deform(points.targets)
    expected = measure(shape.positions, y, shape.faces, points.sources, points.targets)
    assert classic["at_vertices"] == pytest.approx(expected.at_vertices)
    assert classic["curvature"]["mean"] == pytest.approx(expected.curvature.mean)
    assert classic["at_points"] == pytest.approx(0, abs=1e-12)


def test_only_some_methods_if_asked_for(run, moved, refused):
    told = json.loads(run(*moved, "--json", "--methods", "classic,rbf").out)
    assert [method["name"] for method in told["methods"]] == ["classic", "rbf"]
    known = "neural, neural-exact, shape-aware, shape-aware-exact, classic"
    refused(2, *moved, "--methods", "kpd", words=("--methods", known, "'kpd'"))


def test_csv_has_a_row_a_method(run, moved, here):
    assert run(*moved, "-q", "--csv", "all.csv").out == ""
    rows = list(csv.DictReader((here / "all.csv").read_text().splitlines()))
    assert [row["name"] for row in rows] == list(METHODS)
    assert float(rows[1]["strain_dirichlet_mean"]) >= 4
    assert float(rows[1]["at_vertices"]) > 0


def test_deformed_shapes_are_written_if_asked_for(run, moved, here, refused):
    told = json.loads(run(*moved, "-o", "results/all", "--json").out)
    done = [method["name"] for method in told["methods"] if method["measures"] is not None]
    assert told["files"] == [f"results/all/shape-{name}.obj" for name in done]
    for file in told["files"]:
        assert nm.read(file).positions[:, 1].max() > 2.05
    refused(2, *moved, "-o", "results/all", words=("shape-neural.obj", "--force"))
    assert run(*moved, "-o", "results/all", "-q", "--force").code == 0


def test_pictures_are_drawn_if_asked_for(run, moved, here):
    pytest.importorskip("pyvista")
    pytest.importorskip("matplotlib")
    from PIL import Image

    ran = run(*moved, "-q", "--picture", "all.png", "--scatter", "scatter.png")
    assert (ran.code, ran.out, ran.err) == (0, "", "")
    for name in ("all.png", "scatter.png"):
        assert np.asarray(Image.open(here / name)).std() > 5


def test_what_cannot_be_done_is_refused_before_any_work(refused, moved, here):
    refused(2, *moved, "--csv", "all.txt", words=("all.txt", ".csv"))
    refused(2, *moved, "--picture", "all.jpg", words=("all.jpg", ".png"))
    refused(1, *moved, "--scatter", "none/all.png", words=("no folder 'none'",))
    refused(2, *moved, "--csv", "moved.csv", words=("the input itself",))
    refused(1, *moved, "-o", "moved.csv", words=("moved.csv", "folder"))
    refused(1, "compare", "shape.obj", "--points", "points.csv", words=("points.csv: no control point is moved",))
    refused(1, *moved, "--kpd", "shape.obj", words=("shape.obj", ".safetensors"))
    np.save(here / "cloud.npy", np.random.default_rng(0).normal(size=(9, 3)))
    refused(2, "compare", "cloud.npy", *moved[2:], "--scatter", "s.png", words=("--scatter", "cloud.npy has no faces"))


def test_a_cloud_is_compared_by_what_there_is(run, moved, here):
    np.save(here / "cloud.npy", np.random.default_rng(0).uniform(size=(30, 3)) * [1, 2, 1])
    told = json.loads(run("compare", "cloud.npy", *moved[2:], "--json").out)
    by_name = {method["name"]: method for method in told["methods"]}
    assert by_name["classic"]["measures"]["curvature"] is None
    assert by_name["classic"]["measures"]["folded"] is not None
    assert by_name["arap"]["not_applicable"]


def test_figures_of_nothing_are_no_numbers(run, moved, here):
    (here / "flat.obj").write_text("v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n")
    ran = run("compare", "flat.obj", *moved[2:], "--json")
    assert "NaN" not in ran.out
    assert json.loads(ran.out)["methods"][0]["measures"]["curvature"]["mean"] is None
    assert run("compare", "flat.obj", *moved[2:]).code == 0


@pytest.fixture
def folder(here):
    """Poses of a block of points: moved, turned, and a file that is none."""
    rest = np.random.default_rng(0).uniform(size=(40, 3))
    turned = rest @ np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])
    (here / "poses").mkdir()
    faces = np.arange(39).reshape(-1, 3)
    np.savez(here / "poses" / "block.npz", rest=rest, poses=np.stack([rest + 2, turned]), faces=faces)
    return here / "poses"


POSES = ("benchmark", "poses", "poses", "--counts", "4,6")


def test_rigid_motion_is_found_by_moving_least_squares(run, folder):
    told = json.loads(run(*POSES, "--methods", "classic,neural", "--json").out)
    assert [row["control_points"] for row in told["rows"]] == [4, 6]
    for row in told["rows"]:
        assert row["errors"] == {"classic": pytest.approx(0, abs=1e-6), "neural": pytest.approx(0, abs=1e-6)}
        assert row["not_applicable"] == {}


def test_table_of_poses(run, folder):
    pytest.importorskip("igl")
    ran = run(*POSES)
    assert ran.code == 0
    head = next(line for line in ran.out.splitlines() if "control points" in line)
    assert [head.index(word) for word in ("RBF", "Classic", "NeuralMLS", "ARAP")] == sorted(
        head.index(word) for word in ("RBF", "Classic", "NeuralMLS", "ARAP")
    )
    assert "ARAP does not apply to block, 4 control points: ARAP needs" in ran.out


def test_a_bad_file_is_one_sentence_and_the_others_are_measured(run, folder):
    (folder / "bad.npz").write_bytes(b"nothing")
    ran = run(*POSES, "--methods", "classic")
    assert ran.code == 1
    assert ran.err.startswith("neuralmls: error: poses/bad.npz: this is no .npz file of arrays: ")
    assert ran.err.count("\n") == 1
    assert "block" in ran.out
    (folder / "block.npz").unlink()
    ran = run(*POSES, "--methods", "classic")
    assert (ran.code, ran.out) == (1, "")


def test_what_benchmark_cannot_do_is_refused(refused, folder, here):
    (here / "empty").mkdir()
    refused(1, "benchmark", "poses", "none", words=("none", "folder of .npz files"))
    refused(1, "benchmark", "poses", "empty", words=("empty", "no .npz file"))
    refused(2, "benchmark", "poses", "poses", "--methods", "classic,magic", words=("--methods", "'magic'"))
    for counts in ("0", "a", "", "4,,6", "-3"):
        refused(2, "benchmark", "poses", "poses", f"--counts={counts}", words=("--counts",))
    refused(1, *POSES[:3], "--counts", "41", "--methods", "classic", words=("block.npz", "at most 40", "found 41"))
    refused(2, "benchmark", words=("missing command",))


def test_rotations_are_left_out_and_that_is_said(run, here):
    points = (
        nm.ControlPoints.read("points.csv").moved({"top": [0, 1, 0]}).oriented({"top": nm.Orientation((0, 1, 0), 40)})
    )
    points.write("turned.json")
    ran = run("compare", "shape.obj", "--points", "turned.json", "--methods", "rbf")
    assert ran.code == 0
    assert "rotations of control points are left out" in ran.err
