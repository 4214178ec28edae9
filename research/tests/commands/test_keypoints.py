"""`neuralmls keypoints`: control points that every command reads."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import numpy as np
import pytest

import neuralmls as nm
from neuralmls_research.baselines.kpd import KeypointDeformer
from neuralmls_research.metrics import measure


@pytest.fixture
def airplane(here, golden):
    """An airplane of 181 vertices, and weights for it."""
    stored = np.load(golden / "kpd" / "plane2.npz")
    vertices = "".join(f"v {x!r} {y!r} {z!r}\n" for x, y, z in stored["vertices_raw"].astype(float).tolist())
    faces = "".join(f"f {a} {b} {c}\n" for a, b, c in stored["faces"] + 1)
    (here / "plane.obj").write_text(vertices + faces)
    shutil.copy(golden / "kpd" / "weights" / "kpd_airplane_8kpt.safetensors", here / "airplane.safetensors")
    return stored


ASKED = ("keypoints", "plane.obj", "--weights", "airplane.safetensors", "-o", "points.json")


def test_the_keypoints_are_the_published_code_s_and_deform_reads_them(run, airplane):
    ran = run(*ASKED)
    assert (ran.code, ran.err) == (0, "")
    assert "points.json: 8 control points, which KeypointDeformer found on plane.obj" in ran.out
    points = nm.ControlPoints.read("points.json")
    assert points.names == tuple(f"keypoint {number}" for number in range(1, 9))
    expected = airplane["keypoints"] * airplane["scale"] + airplane["center"]
    np.testing.assert_allclose(points.sources, expected, atol=1e-6)
    assert np.array_equal(points.sources, points.targets)
    assert json.loads(Path("points.json").read_text())["version"] == 2
    assert run("deform", "plane.obj", "--points", "points.json", "-o", "same.obj", "--steps", "2").code == 0


def test_moved_keypoints_are_compared_with_keypoint_deformer_among_the_methods(run, airplane):
    run(*ASKED)
    points = nm.ControlPoints.read("points.json")
    points.moved({"keypoint 8": [0.1, 0, 0]}).write("moved.json")
    asked = ("compare", "plane.obj", "--points", "moved.json", "--kpd", "airplane.safetensors")
    told = json.loads(run(*asked, "--methods", "classic,keypoint-deformer", "--json").out)
    assert [method["name"] for method in told["methods"]] == ["classic", "keypoint-deformer"]
    shape, moved = nm.read("plane.obj"), nm.ControlPoints.read("moved.json")
    y = KeypointDeformer.read("airplane.safetensors").bind(shape).deform(moved.targets)
    expected = measure(shape.positions, y, shape.faces, moved.sources, moved.targets)
    assert told["methods"][1]["measures"]["laplacian"]["mean"] == pytest.approx(expected.laplacian.mean)


def test_a_shape_that_seems_to_face_elsewhere_is_a_warning(run, airplane):
    shape = nm.read("plane.obj")
    shape.write("turned.obj", shape.positions[:, [2, 1, 0]])
    ran = run("keypoints", "turned.obj", *ASKED[2:])
    assert ran.code == 0
    assert "turned.obj: keypoints are found on shapes that face +x with y up, and this one is longer along z" in ran.err


def test_what_keypoints_cannot_do_is_refused(refused, airplane, here):
    refused(2, *ASKED[:-1], "points.txt", words=("points.txt", ".json"))
    refused(2, *ASKED[:-1], "plane.obj", words=("plane.obj",))
    refused(1, *ASKED[:3], "plane.obj", *ASKED[4:], words=("plane.obj", ".safetensors"))
    (here / "points.json").write_text("mine")
    refused(2, *ASKED, words=("points.json", "--force"))
