"""`neuralmls compare`."""

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
    refused(2, *moved, "--methods", "keypoint-deformer", words=("--methods", known, "'keypoint-deformer'"))


def test_csv_has_a_row_a_method(run, moved, here):
    assert run(*moved, "-q", "--csv", "all.csv").out == ""
    rows = list(csv.DictReader((here / "all.csv").read_text().splitlines()))
    assert [row["name"] for row in rows] == list(METHODS)
    assert float(rows[1]["strain_dirichlet_mean"]) >= 4
    assert float(rows[1]["at_vertices"]) > 0
    alphas = {row["name"]: row["settings_weights_alpha"] for row in rows}
    assert (alphas["classic"], alphas["neural"], alphas["rbf"]) == ("0.5", "", "")
    assert not {"settings", "measures", "seeds"} & rows[0].keys()


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


def test_rotations_are_left_out_and_that_is_said(run, here):
    points = (
        nm.ControlPoints.read("points.csv").moved({"top": [0, 1, 0]}).oriented({"top": nm.Orientation((0, 1, 0), 40)})
    )
    points.write("turned.json")
    ran = run("compare", "shape.obj", "--points", "turned.json", "--methods", "rbf")
    assert ran.code == 0
    assert "rotations of control points are left out" in ran.err


def by_name(told):
    return {method["name"]: method for method in told["methods"]}


def test_settings_reach_the_methods_that_have_them_and_are_told(run, moved):
    said = ("--alpha", "2", "--temperature", "0.5", "--transform", "affine", "--steps", "7", "--width", "32")
    chosen = ("--methods", "neural,classic,rbf")
    told = by_name(json.loads(run(*moved, "--json", *chosen, *said, "--seed", "3").out))
    weights = told["neural"]["settings"]["weights"]
    assert (weights["steps"], weights["width"], weights["seed"]) == (7, 32, 3)
    assert told["classic"]["settings"]["weights"]["alpha"] == 2
    for name in ("neural", "classic"):
        assert (told[name]["settings"]["temperature"], told[name]["settings"]["transform"]) == (0.5, "affine")
    assert told["rbf"]["settings"] is None
    out = run(*moved, *chosen, *said).out
    assert "Classic MLS (alpha 2: 1/d^4, affine, temperature 0.5)" in out
    assert "alpha 2: 1/d^4, epsilon 0, affine, temperature 0.5, handles soft" in out
    shape, points = nm.read("shape.obj"), nm.ControlPoints.read("moved.csv")
    y = nm.Deformer(shape.positions, nm.InverseDistanceWeights(points.sources, alpha=2), transform="affine").deform(
        points.targets, 0.5
    )
    expected = measure(shape.positions, y, shape.faces, points.sources, points.targets)
    assert told["classic"]["measures"]["laplacian"]["mean"] == pytest.approx(expected.laplacian.mean)


def test_settings_of_a_session_hold_where_nothing_else_is_said(run, moved):
    points = nm.ControlPoints.read("moved.csv")
    nm.Session(points, weights="inverse-distance", alpha=1.5, temperature=0.7).write("session.json")
    asked = ("compare", "shape.obj", "--points", "session.json", "--methods", "neural,classic", "--json")
    told = by_name(json.loads(run(*asked).out))
    assert told["classic"]["settings"]["weights"]["alpha"] == 1.5
    assert {method["settings"]["temperature"] for method in told.values()} == {0.7}
    told = by_name(json.loads(run(*asked, "--alpha", "1", "--temperature", "2").out))
    assert told["classic"]["settings"]["weights"]["alpha"] == 1
    assert {method["settings"]["temperature"] for method in told.values()} == {2}


def test_settings_out_of_range_or_of_no_method_are_refused(refused, moved):
    refused(2, *moved, "--temperature", "0", words=("temperature: expected a number above 0",))
    refused(2, *moved, "--steps", "-1", words=("steps",))
    refused(2, *moved, "--methods", "neural,rbf", "--alpha", "1", words=("alpha", "none of the methods neural, rbf"))
    refused(2, *moved, "--seeds", "0", words=("--seeds: expected 1 to",))


def test_seeds_give_means_deviations_and_what_hangs_on_them(run, moved):
    asked = (*moved, "--methods", "neural,classic", "--steps", "3", "--width", "16", "--seed", "5")
    told = by_name(json.loads(run(*asked, "--seeds", "3", "--json").out))
    each = [run["measures"]["at_points"] for run in told["neural"]["seeds"]]
    assert [run["seed"] for run in told["neural"]["seeds"]] == [5, 6, 7]
    assert len(set(each)) == 3
    assert told["neural"]["measures"]["at_points"] == pytest.approx(np.mean(each))
    assert told["neural"]["deviation"]["at_points"] == pytest.approx(np.std(each, ddof=1))
    assert "deviation" not in told["classic"]
    alone = by_name(json.loads(run(*asked[:-1], "6", "--json").out))
    assert alone["neural"]["measures"]["at_points"] == pytest.approx(each[1])
    ran = run(*asked, "--seeds", "3")
    assert "mean ± deviation over seeds 5 to 7: neural" in ran.out
    assert ran.out.count(" ± ") > 8


def test_orders_that_hang_on_a_seed_are_named():
    from neuralmls_research.commands.comparison import _orders

    def method(name, *values):
        runs = [{"seed": seed, "measures": {"at_points": value}} for seed, value in enumerate(values)]
        return {"name": name, "measures": runs[0]["measures"], **({"seeds": runs} if len(runs) > 1 else {})}

    rest = dict.fromkeys(("at_vertices", "curvature", "laplacian", "strain"))
    methods = [method("neural", 1.0, 1.2, 2.5), method("classic", 2.0)]
    for one in methods:
        for run_of_it in one.get("seeds", [one]):
            run_of_it["measures"] = {**rest, **run_of_it["measures"]}
    assert _orders(methods) == [
        {"measure": "off targets, at the point", "better": "neural", "worse": "classic", "seeds": (2,)}
    ]
