"""KeypointDeformer against what the published code gives on two airplanes.

`pytest tests/baselines/test_kpd_golden.py -s` prints the worst differences.
"""

from __future__ import annotations

import numpy as np
import pytest

import neuralmls as nm
from neuralmls_research import baselines
from neuralmls_research.baselines.kpd import KeypointDeformer
from neuralmls_research.baselines.kpd.cage import RADIUS, icosphere
from neuralmls_research.baselines.kpd.mean_value import mean_value_coordinates
from neuralmls_research.baselines.kpd.model import normalise

AIRPLANES = ("plane1", "plane2", "plane3")
# Sine of a dihedral angle below which a point is so near to the plane of a cage's face that the published code's single
# precision takes the cosine for 1, and then for 1 - 1e-5. Its coordinates do not give such a vertex back, ours do: at
# rest they put 49 of plane1's 19,078 more than 1e-5 away, one by 4e-4. What it gives there hangs on the last bit of
# PyTorch's norm, sine and arcsine (the same formulas in NumPy's single precision do not repeat it).
NEAR_A_PLANE = 0.01


@pytest.fixture(scope="module", params=AIRPLANES)
def golden_plane(request, golden):
    folder = golden / "kpd"
    if not (folder / f"{request.param}.npz").is_file():
        pytest.skip(f"no {request.param}.npz in {folder}")
    return request.param, np.load(folder / f"{request.param}.npz"), folder / "weights"


@pytest.fixture(scope="module")
def bound(golden_plane, tmp_path_factory):
    _, given, weights = golden_plane
    path = tmp_path_factory.mktemp("plane") / "plane.npy"
    np.save(path, given["vertices_raw"].astype(np.float64))
    return KeypointDeformer.read(weights / "kpd_airplane_8kpt.safetensors").bind(nm.read(path))


def report(plane, what, difference, bound):
    worst = float(np.abs(difference).max())
    print(f"{plane} {what:<46} {worst:.1e}")
    assert worst <= bound


def test_keypoints_cage_and_influence_agree(golden_plane, bound):
    plane, given, _ = golden_plane
    v, faces = icosphere()
    report(plane, "cage before", v - given["cage_template"], 1e-7)
    assert np.array_equal(faces, given["cage_f"])
    report(plane, "scale", (bound.scale - given["scale"]) / bound.scale, 1e-7)
    report(plane, "keypoints", (bound.keypoints - bound.centre) / bound.scale - given["keypoints"], 1e-6)
    report(plane, "cage", bound.cage - given["cage_v"], 1e-6)
    steps = np.log(np.linalg.norm(bound.cage, axis=1) / RADIUS) / np.log(0.99)
    np.testing.assert_allclose(steps, given["cage_updates"], atol=1e-9)
    assert np.array_equal(bound.influence != 0, given["keep"])
    report(plane, "influence", bound.influence - given["influence"], 1e-6)


def test_mean_value_coordinates_agree_in_double_precision(golden_plane):
    plane, given, _ = golden_plane
    x, cage = given["vertices"][given["mvc_idx"]].astype(np.float64), given["cage_v"].astype(np.float64)
    w = mean_value_coordinates(x, cage, given["cage_f"])
    report(plane, "mean value coordinates", w - given["mvc_weights_f64"], 1e-9)


def test_mean_value_coordinates_give_every_vertex_back(golden_plane, bound):
    plane, given, _ = golden_plane
    x, _, _ = normalise(given["vertices_raw"].astype(np.float64))
    report(plane, "vertices from their coordinates", bound.coordinates @ bound.cage - x, 1e-12)


def test_deformed_vertices_agree(golden_plane, bound):
    plane, given, _ = golden_plane
    x, _, _ = normalise(given["vertices_raw"].astype(np.float64))
    sound = least_sine(x, bound.cage) > NEAR_A_PLANE
    assert sound.mean() > 0.95
    for case, offsets, expected in zip(given["case_names"], given["offsets"], given["deformed"], strict=True):
        y = bound.deform(bound.keypoints + offsets.astype(np.float64) * bound.scale)
        difference = (y - bound.centre) / bound.scale - expected
        report(plane, f"deformed, {case}", difference[sound], 1e-5)
        report(plane, f"  {(~sound).sum()} vertices near a face's plane", difference[~sound], 1e-3)


def least_sine(x, cage):
    """The least sine of the dihedral angles of the cage's faces, seen from each point."""
    _, faces = icosphere()
    least = []
    for some in np.array_split(x, len(x) // 1000 + 1):
        u = cage - some[:, None]
        u = (u / np.linalg.norm(u, axis=2, keepdims=True))[:, faces]
        normals = np.cross(u[:, :, [1, 2, 0]], u[:, :, [2, 0, 1]])
        normals /= np.linalg.norm(normals, axis=3, keepdims=True)
        cross = np.cross(normals[:, :, [1, 2, 0]], normals[:, :, [2, 0, 1]])
        least.append(np.linalg.norm(cross, axis=3).min(axis=(1, 2)))
    return np.concatenate(least)


def test_the_baseline_takes_the_paper_s_control_points(golden_plane, bound, tmp_path):
    _, given, _ = golden_plane
    np.save(tmp_path / "plane.npy", given["vertices_raw"].astype(np.float64))
    plane = nm.read(tmp_path / "plane.npy")
    p = given["keypoints_hardcoded"] * bound.scale + bound.centre  # with four digits
    offsets = given["offsets"][2].astype(np.float64) * bound.scale
    y = baselines.get("kpd")(plane, p, p + offsets, network=bound)
    np.testing.assert_allclose(y, bound.deform(bound.keypoints + offsets), atol=1e-12)
