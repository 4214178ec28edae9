"""A list of one landmark is bent as any other shape is, where the box of the weights is known."""

from __future__ import annotations

import json

import numpy as np
import pytest

import neuralmls as nm

SIDE = 4.0


@pytest.fixture
def framed(here):
    """A session with a frame, and files of one landmark and of two at one place."""
    points = nm.ControlPoints([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0.0, 0, 0], [1, 0, 0.5], [0, 1, 0]])
    session = nm.Session(points, weights="inverse-distance", frame=[[-2] * 3, [2] * 3])
    session.write("framed.json")
    (here / "one.csv").write_text("name,x,y,z\nnose,1,0,0\n")
    (here / "same.csv").write_text("x,y,z\n1,0,0\n1,0,0\n")
    return session


@pytest.mark.parametrize("shape", ["one.csv", "same.csv"])
def test_a_landmark_without_a_size_is_bent_by_a_framed_session_and_by_a_map(run, framed, shape):
    ran = run("deform", shape, "--points", "framed.json", "-o", "bent.csv", "--json", "--check")
    assert (ran.code, ran.err) == (0, "")
    told = json.loads(ran.out)
    assert (told["longest_side"], told["side"]) == (0.0, SIDE)
    assert np.allclose(nm.read("bent.csv").positions, [1, 0, 0.5], atol=1e-9)
    assert run("fit", shape, "--points", "framed.json", "-o", "own.map").code == 0
    framed.fit().save("body.map")
    for saved in ("own.map", "body.map"):
        ran = run("deform", shape, "--map", saved, "-o", "by_map.csv", "--force")
        assert (ran.code, ran.err) == (0, "")
        assert "0.00 %" in ran.out
        assert np.array_equal(nm.read("by_map.csv").positions, nm.read("bent.csv").positions)


def test_without_a_box_it_is_refused(run, framed):
    framed.points.write("points.csv")
    ran = run("deform", "one.csv", "--points", "points.csv", "-o", "bent.csv")
    assert ran.code == 1
    assert "one.csv: there is only one vertex, so that there is no size to measure by" in ran.err


def test_distances_are_told_in_parts_of_the_box_of_the_weights(run, framed):
    framed.fit().save("body.map")
    ran = run("deform", "one.csv", "--map", "body.map", "-o", "bent.csv", "--handles", "soft", "--temperature", "3")
    told = framed.replace(handles="soft", temperature=3.0).fit().report()
    assert f"{100 * told.distance_to_target[1] / SIDE:.2f} %" in ran.out
    assert framed.fit().side == SIDE
