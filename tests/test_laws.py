"""Laws that hold for any points, control points, weights and temperatures, through the public functions."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

import neuralmls as nm

TRANSFORMS = ["rigid", "similarity", "affine"]
TEMPERATURES = st.sampled_from([0.02, 0.3, 1.0, 5.0, 100.0])
X = np.random.default_rng(0).uniform(-1, 1, (50, 3))


@pytest.fixture(scope="module", params=["neural", "inverse-distance"])
def weights(request):
    """A weight function of six control points that span the space."""
    p = np.random.default_rng(1).uniform(-1, 1, (6, 3))
    if request.param == "neural":
        return nm.NeuralWeights.fit(p, bounds=[[-1] * 3, [1] * 3], width=128)
    return nm.InverseDistanceWeights(p, alpha=1.5)


def points(m, d=3):
    return arrays(np.float64, (m, d), elements=st.floats(-1, 1, width=32))


@st.composite
def rotations(draw):
    w, x, y, z = draw(arrays(np.float64, 4, elements=st.floats(-1, 1)).filter(lambda u: u @ u > 0.1))
    n = w * w + x * x + y * y + z * z
    return np.eye(3) + 2 / n * np.array(
        [
            [-y * y - z * z, x * y - w * z, x * z + w * y],
            [x * y + w * z, -x * x - z * z, y * z - w * x],
            [x * z - w * y, y * z + w * x, -x * x - y * y],
        ]
    )


@pytest.mark.parametrize("transform", TRANSFORMS)
@given(temperature=TEMPERATURES)
def test_unmoved_control_points_return_the_input_bit_for_bit(weights, transform, temperature):
    y = nm.Deformer(X, weights, transform=transform).deform(weights.control_points, temperature)
    assert y.tobytes() == X.tobytes()


@pytest.mark.parametrize("transform", TRANSFORMS)
@given(rotation=rotations(), shift=points(1), temperature=TEMPERATURES)
def test_a_rigid_motion_of_all_control_points_moves_every_point_by_it(weights, transform, rotation, shift, temperature):
    move = lambda v: v @ rotation.T + shift
    y = nm.Deformer(X, weights, transform=transform).deform(move(weights.control_points), temperature)
    assert np.abs(y - move(X)).max() < 1e-5


@pytest.mark.parametrize("transform", ["similarity", "affine"])
@given(rotation=rotations(), scale=st.floats(0.1, 4), temperature=TEMPERATURES)
def test_a_similarity_of_all_control_points_moves_every_point_by_it(weights, transform, rotation, scale, temperature):
    move = lambda v: scale * v @ rotation.T + 0.3
    y = nm.Deformer(X, weights, transform=transform).deform(move(weights.control_points), temperature)
    assert np.abs(y - move(X)).max() < 1e-5


@given(matrix=points(3), temperature=TEMPERATURES)
def test_an_affine_map_of_all_control_points_moves_every_point_by_it(weights, matrix, temperature):
    move = lambda v: v @ matrix.T - 0.2
    y = nm.Deformer(X, weights, transform="affine").deform(move(weights.control_points), temperature)
    assert np.abs(y - move(X)).max() < 1e-5


@pytest.mark.parametrize("name", ["neural", "inverse-distance"])
@pytest.mark.parametrize("transform", TRANSFORMS)
@settings(max_examples=5, deadline=None)
@given(order=st.permutations(range(6)), q=points(6))
def test_the_order_of_the_control_points_does_not_matter(name, transform, order, q):
    p = np.random.default_rng(2).uniform(-1, 1, (6, 3))
    here = nm.deform(X, p, q, weights=name, transform=transform)
    there = nm.deform(X, p[order], q[order], weights=name, transform=transform)
    assert np.abs(here - there).max() < 1e-6


@pytest.mark.parametrize("name", ["neural", "inverse-distance"])
@pytest.mark.parametrize("transform", TRANSFORMS)
@pytest.mark.parametrize(("scale", "shift"), [(1.0, 3.0), (1000.0, 0.0), (0.001, 5.0), (4.0, -64.0)])
def test_scale_and_place_of_the_world_do_not_matter(name, transform, scale, shift):
    rng = np.random.default_rng(3)
    p, q = rng.uniform(-1, 1, (2, 6, 3))
    world = lambda v: scale * v + shift
    here = world(nm.deform(X, p, q, weights=name, transform=transform))
    there = nm.deform(world(X), world(p), world(q), weights=name, transform=transform)
    assert np.abs(here - there).max() < 1e-4 * scale


@settings(deadline=None)
@given(p=points(2), q=points(2))
def test_mirrored_and_coincident_targets_stay_finite(p, q):
    if (p[0] == p[1]).all():
        return
    for transform in TRANSFORMS:
        for targets in (q, -p, np.repeat(q[:1], 2, axis=0)):
            y = nm.deform(X, p, targets, weights="inverse-distance", transform=transform)
            assert np.isfinite(y).all()


def test_one_seed_gives_the_same_bytes_for_one_and_two_threads(tmp_path):
    """The number of threads is fixed when the process starts: two processes."""
    import subprocess
    import sys

    script = tmp_path / "once.py"
    script.write_text(
        "import sys, numpy as np, neuralmls as nm\n"
        "rng = np.random.default_rng(0)\n"
        "x, p, q = rng.uniform(-1, 1, (5000, 3)), rng.uniform(-1, 1, (7, 3)), rng.uniform(-1, 1, (7, 3))\n"
        "sys.stdout.buffer.write(nm.deform(x, p, q, seed=4).tobytes())\n"
    )
    import os

    def run(threads: str) -> bytes:
        environment = {**os.environ, "RAYON_NUM_THREADS": threads}
        return subprocess.run([sys.executable, script], env=environment, capture_output=True, check=True).stdout

    one = run("1")
    assert len(one) == 5000 * 24
    assert one == run("2")
