"""What a person should know of a deformation is said: files too coarse for it, mirror images, wrong axes and units."""

from __future__ import annotations

import json
import struct

import numpy as np
import pytest

import neuralmls as nm

CLASSIC = ("--weights", "inverse-distance")
FAR = 5_000_000


def ply(path, positions, kind):
    """A binary PLY of points, of `float` or `double`."""
    header = f"ply\nformat binary_little_endian 1.0\nelement vertex {len(positions)}\n"
    header += "".join(f"property {kind} {axis}\n" for axis in "xyz") + "end_header\n"
    code = {"float": "<3f", "double": "<3d"}[kind]
    path.write_bytes(header.encode() + b"".join(struct.pack(code, *point) for point in positions))


@pytest.fixture
def far(here):
    """A metre of points five million metres from the origin, and control points that lie there."""
    positions = FAR + 8 * np.random.default_rng(0).uniform(-1, 1, (40, 3)).round(1)
    ply(here / "float.ply", positions, "float")
    ply(here / "double.ply", positions, "double")
    p = np.array([[-4.0, 0, 0], [4, 0, 0], [0, 4, 0], [0, 0, 4]]) + FAR
    q = p.copy()
    q[1, 0] += 0.05
    nm.ControlPoints(p, q).write(here / "far.csv")
    return here


def test_a_float_file_that_cannot_hold_the_motion_says_what_was_written(run, far):
    ran = run("deform", "float.ply", "--points", "far.csv", "-o", "out.ply", "--json", *CLASSIC)
    told = json.loads(ran.out)
    [warning] = told["warnings"]
    assert ran.err == f"neuralmls: warning: {warning}\n"
    assert "in steps of 0.5 here, too coarse for moves of at most 0.05" in warning
    moved = {point["name"]: point for point in told["control_points"]}["p2"]
    assert moved["moved"] == pytest.approx(0.05)
    # p2 would have arrived at 5000004.05: in this file it is at 5000004.
    assert moved["distance_to_target"] == pytest.approx(0.05)
    written = nm.read("out.ply").positions
    assert np.array_equal(written, written.astype(np.float32))


def test_a_double_file_at_the_same_place_holds_it(run, far):
    ran = run("deform", "double.ply", "--points", "far.csv", "-o", "out.ply", "--json", *CLASSIC)
    told = json.loads(ran.out)
    assert (ran.err, told["warnings"]) == ("", [])
    assert max(point["distance_to_target"] for point in told["control_points"]) < 1e-6
    assert np.abs(nm.read("out.ply").positions - nm.read("double.ply").positions).max() > 0.01


def block(here):
    """A block of points that is no mirror image of itself."""
    rng = np.random.default_rng(1)
    x = rng.uniform(0, 1, (60, 3)) * [2, 1, 0.5]
    np.save(here / "block.npy", x)
    return x[:8]


def test_mirrored_targets_are_said_with_what_can_make_them(run, here):
    p = block(here)
    nm.ControlPoints(p, p * [-1, 1, 1]).write("mirrored.csv")
    ran = run("deform", "block.npy", "--points", "mirrored.csv", "-o", "out.npy", "--handles", "soft", *CLASSIC)
    assert ran.code == 0
    [line] = [line for line in ran.err.splitlines() if "mirror image" in line]
    assert line.startswith("neuralmls: warning: ")
    assert "affine" in line
    affine = run("deform", "block.npy", "--points", "mirrored.csv", "-o", "a.npy", "--transform", "affine", *CLASSIC)
    assert affine.code == 0
    np.testing.assert_allclose(nm.read("a.npy").positions, nm.read("block.npy").positions * [-1, 1, 1], atol=1e-6)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ([-1, -1, 1], ("LPS", "RAS")),
        (1000, ("times 1/1000",)),
        (0.001, ("times 1000",)),
    ],
)
def test_control_points_in_other_axes_or_units_are_said_with_what_would_fit(run, here, change, words):
    p = block(here) * np.asarray(change, float)
    nm.ControlPoints(p, p + 0.01).write("other.csv")
    ran = run("deform", "block.npy", "--points", "other.csv", "-o", "out.npy", *CLASSIC)
    assert ran.code == 0
    for word in words:
        assert any(word in line for line in ran.err.splitlines()), ran.err
