"""`neuralmls fit` and `neuralmls deform --map`: weights fitted once, and used with other targets, on other files."""

from __future__ import annotations

import json

import numpy as np
import pytest

import neuralmls as nm

QUICK = ("--width", "32", "--steps", "200")
FIT = ("fit", "shape.obj", "--points", "moved.csv", "-o", "shape.map")
BY_MAP = ("deform", "shape.obj", "--map", "shape.map")


@pytest.fixture
def moved(here):
    """points.csv with targets, and the same with others."""
    points = nm.ControlPoints.read("points.csv")
    points.moved({"top": [0.25, 0.5, 0]}).write("moved.csv")
    points.moved({"foot": [0, -0.5, 0.25]}).write("other.csv")


@pytest.mark.parametrize("options", [QUICK, ("--weights", "inverse-distance"), ("--weights", "shape-aware")])
def test_a_saved_map_deforms_as_the_run_that_fits(run, here, moved, options):
    settings = (*options, "--temperature", "0.8", "--transform", "similarity", "--handles", "0.5")
    ran = run(*FIT, *settings)
    assert (ran.code, ran.err) == (0, "")
    assert ran.out.startswith("shape.map: a map of 3 control points, ")
    assert run("deform", "shape.obj", "--points", "moved.csv", "-o", "fitted.obj", *settings, "-q").code == 0
    ran = run(*BY_MAP, "-o", "by-map.obj", "--json")
    assert (ran.code, ran.err) == (0, "")
    assert (here / "by-map.obj").read_bytes() == (here / "fitted.obj").read_bytes()
    told = json.loads(ran.out)
    assert (told["temperature"], told["transform"], told["handles"]) == (0.8, "similarity", 0.5)
    assert list(told["seconds"]) == ["read", "bind", "move", "write"]
    assert np.array_equal(nm.Map.load("shape.map").at([[0.5, 1, 0]]), nm.Map.load("shape.map").at([[0.5, 1, 0]]))


def test_fit_says_how_to_go_on(run, moved):
    ran = run(*FIT, *QUICK)
    tried = ran.out[ran.out.index("deform ") :].split()
    assert run(*tried).code == 0
    assert run(*FIT[:-1], "quiet.map", *QUICK, "-q").out == ""


def test_other_targets_and_settings_need_no_fit(run, here, moved):
    assert run(*FIT, *QUICK).code == 0
    for options in ((), ("--handles", "soft"), ("--handles", "exact", "--transform", "affine", "--temperature", "2")):
        name = f"{len(options)}.obj"
        ran = run(*BY_MAP, "--points", "other.csv", "-o", name, *options, "--json")
        assert (ran.code, "train" in json.loads(ran.out)["seconds"]) == (0, False)
        assert run("deform", "shape.obj", "--points", "other.csv", "-o", f"fit-{name}", *QUICK, *options).code == 0
        assert (here / name).read_bytes() == (here / f"fit-{name}").read_bytes()
    assert run(*BY_MAP, "-o", "turned.obj", "--turn", "top=y,40", "--move", "foot=0,-1,0").code == 0


def test_what_a_session_sets_holds_with_a_map_too(run, here, moved):
    assert run(*FIT, *QUICK).code == 0
    nm.Session(nm.ControlPoints.read("other.csv"), temperature=2.5, handles="soft").write("set.json")
    told = json.loads(run(*BY_MAP, "--points", "set.json", "-o", "a.obj", "--json").out)
    assert (told["temperature"], told["handles"], told["session"]) == (2.5, "soft", "set.json")
    told = json.loads(run(*BY_MAP, "--points", "set.json", "-o", "b.obj", "--json", "--handles", "exact").out)
    assert (told["temperature"], told["handles"]) == (2.5, "exact")


@pytest.mark.parametrize(
    "options",
    [("--weights", "inverse-distance"), ("--weights", "shape-aware"), ("--width", "64"), ("--seed", "3")],
)
def test_other_weights_need_a_fit(run, refused, moved, options):
    assert run(*FIT, *QUICK).code == 0
    refused(2, *BY_MAP, "-o", "out.obj", *options, words=("the map was fitted with other weights",))


def test_other_control_points_need_a_fit(run, refused, here, moved):
    assert run(*FIT, *QUICK).code == 0
    (here / "elsewhere.csv").write_text("name,x,y,z\nfoot,0.5,0,0.5\nside,1,1,0.25\ntop,0.5,2,0.5\n")
    words = ("elsewhere.csv, for shape.map", "other control points at rest")
    refused(2, *BY_MAP, "--points", "elsewhere.csv", "-o", "out.obj", words=words)


def test_what_is_no_map_is_refused(refused, here):
    (here / "no.map").write_text("nothing")
    refused(1, "deform", "shape.obj", "--map", "no.map", "-o", "out.obj", words=("no.map",))
    refused(1, "deform", "shape.obj", "--map", "none.map", "-o", "out.obj", words=("none.map: there is no such file",))
    refused(1, "deform", "shape.obj", "--map", "points.csv", "-o", "out.obj", words=("points.csv",))


def test_a_map_in_the_place_of_control_points_is_called_one(run, refused, moved):
    assert run(*FIT, *QUICK).code == 0
    words = ("shape.map: this is a saved map, not control points", "--map")
    refused(1, "deform", "shape.obj", "--points", "shape.map", "-o", "out.obj", words=words)


def test_a_map_is_never_written_over_without_force(run, refused, here, moved):
    assert run(*FIT, *QUICK).code == 0
    refused(2, *FIT, *QUICK, words=("shape.map", "--force"))
    assert run(*FIT, *QUICK, "--force").code == 0
    refused(2, *FIT[:-1], "moved.csv", words=("the input itself",))
    refused(2, "fit", "shape.obj", "-o", "a.map", words=("--points",))
    refused(2, *BY_MAP, "-o", "shape.map", words=("shape.map", "the input itself"))


def test_a_second_file_belongs_to_a_first(run, refused, moved):
    assert run(*FIT, *QUICK).code == 0
    for option in (("--targets", "other.csv"), ("--by-order",)):
        refused(2, *BY_MAP, "-o", "out.obj", *option, words=("--points", "--targets"))


def test_a_map_bends_a_file_that_lies_elsewhere_in_its_space(run, here, moved):
    """A badge far from most control points: they are none of its mistakes."""
    assert run(*FIT, *QUICK).code == 0
    (here / "badge.xyz").write_text("0.5 1.9 0.5\n0.6 1.9 0.5\n0.5 1.95 0.5\n")
    ran = run("deform", "badge.xyz", "--map", "shape.map", "-o", "out.xyz")
    assert (ran.code, ran.err) == (0, "")
    expected = nm.Map.load("shape.map").at(nm.read("badge.xyz").positions)
    np.testing.assert_allclose(nm.read("out.xyz").positions, expected, rtol=0, atol=1e-6)
