"""Agreement with the published implementation, and where it reflects or loses its digits, with double precision.

`pytest tests/test_golden.py -s` prints the worst absolute difference of each group.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import neuralmls as nm
from neuralmls import _core

CASES = range(3)
SHAPES = ("chair1", "plane1")


class Given:
    """A weight function whose logits are known already."""

    def __init__(self, control_points, logits):
        self.control_points = control_points
        self._logits = logits

    def logits(self, _x, *, progress=None):
        return self._logits


@pytest.fixture(scope="module", params=SHAPES)
def reference(request, golden: Path) -> Any:
    return np.load(golden / f"reference_{request.param}.npz")


def given(reference):
    return (reference[name].astype(np.float64) for name in ("points", "control_points", "targets"))


def network(reference, p, width: int, when: str) -> _core.Weights:
    layers = [
        (np.ascontiguousarray(reference[f"w{width}_{when}_W{i}"]), reference[f"w{width}_{when}_b{i}"]) for i in range(3)
    ]
    return _core.Weights.of_layers(np.ascontiguousarray(p), [0.0] * 3, 1.0, np.zeros((0, 3), np.float32), layers)


def moments(p, q, logits, temperature):
    """Plain moving least squares in double precision: centroids, C and P of every point."""
    w = nm.softmax(logits, temperature)
    p_mean, q_mean = w @ p, w @ q
    a, b = p - p_mean[:, None], q - q_mean[:, None]
    return p_mean, q_mean, np.einsum("nm,nmi,nmj->nij", w, a, b), np.einsum("nm,nmi,nmj->nij", w, a, a)


def nearest_rotation(c):
    """The rotation that maximises tr(R C), by SVD, with the sign put where it costs least."""
    u, _, vt = np.linalg.svd(c)
    sign = np.ones(c.shape[:-1])
    sign[..., -1] = np.sign(np.linalg.det(u) * np.linalg.det(vt))
    return np.einsum("...ji,...j,...kj->...ik", vt, sign, u)


def by_the_rule(x, p, q, logits, temperature):
    """DESIGN's rule for the rotation in double precision, by SVD, from the accurate form of C."""
    ordered = np.sort(logits, axis=1)
    k = logits.argmax(axis=1)
    r = np.exp((logits - ordered[:, -2:-1]) / temperature)
    np.put_along_axis(r, k[:, None], 0.0, axis=1)
    ratio = np.exp((ordered[:, -2] - ordered[:, -1]) / temperature)
    second = ratio / (1 + ratio * r.sum(axis=1))
    a, b = p - p[k][:, None], q - q[k][:, None]
    sum_a, sum_b = np.einsum("nm,nmi->ni", r, a), np.einsum("nm,nmi->ni", r, b)
    c = np.einsum("nm,nmi,nmj->nij", r, a, b) - second[:, None, None] * sum_a[:, :, None] * sum_b[:, None, :]
    c /= np.linalg.norm(c, axis=(1, 2), keepdims=True)
    whole = (p - p.mean(axis=0)).T @ (q - q.mean(axis=0))
    g = nearest_rotation(whole / np.linalg.norm(whole) + 1e-9 * np.eye(3))
    rotation = nearest_rotation(c + 1e-9 * g.T)
    p_mean, q_mean = p[k] + second[:, None] * sum_a, q[k] + second[:, None] * sum_b
    return np.einsum("nij,nj->ni", rotation, x - p_mean) + q_mean


def report(group: str, differences) -> float:
    worst = float(max(np.max(d) for d in differences))
    print(f"{group:<58} {worst:.1e}")
    return worst


@pytest.mark.parametrize("alpha", [0.5, 1, 2])
def test_rigid_deformation_by_classic_weights_agrees(reference, alpha):
    x, p, q = given(reference)
    deformer = nm.Deformer(x, nm.InverseDistanceWeights(p, alpha=alpha))
    differences = [np.abs(deformer.deform(q[c]) - reference[f"mls_rigid_alpha{alpha}_case{c}"]) for c in CASES]
    assert report(f"classic rigid alpha {alpha}, {len(p)} points", differences) < 1e-6


@pytest.mark.parametrize("alpha", [0.5, 1, 2])
def test_affine_deformation_by_classic_weights_agrees_with_double_precision(reference, alpha):
    x, p, q = given(reference)
    logits = -alpha * np.log(((x[:, None] - p) ** 2).sum(axis=2))
    deformer = nm.Deformer(x, nm.InverseDistanceWeights(p, alpha=alpha), transform="affine")
    expected = [reference[f"mls_affine_alpha{alpha}_case{c}"] for c in CASES]
    affine_agrees(f"classic affine alpha {alpha}", deformer, x, p, q, logits, 1.0, expected)


@pytest.mark.parametrize("temperature", [1, 3])
@pytest.mark.parametrize("width", [128, 1024])
def test_rigid_deformation_from_given_logits_agrees_where_the_reference_does_not_reflect(reference, width, temperature):
    x, p, q = given(reference)
    logits = reference[f"w{width}_logits64"]
    deformer = nm.Deformer(x, Given(p, logits))
    for c in CASES:
        _, _, moment, _ = moments(p, q[c], logits, temperature)
        reflects = np.linalg.det(moment) < 0
        expected = reference[f"neural_w{width}_T{temperature}_rigid_case{c}"]
        difference = np.abs(deformer.deform(q[c], temperature) - expected).max(axis=1)
        group = f"neural {width} rigid T {temperature} case {c}, {len(p)} points, {reflects.sum()} reflected"
        assert report(group, [difference[~reflects]]) < 1e-6
        assert (difference[reflects] > 1e-6).all()
        _, maps = deformer.deform(q[c], temperature, return_maps=True)
        assert np.abs(np.linalg.det(maps) - 1).max() < 1e-12


@pytest.mark.parametrize("temperature", [1, 3])
@pytest.mark.parametrize("width", [128, 1024])
def test_affine_deformation_from_given_logits_agrees_with_double_precision(reference, width, temperature):
    x, p, q = given(reference)
    logits = reference[f"w{width}_logits64"]
    deformer = nm.Deformer(x, Given(p, logits), transform="affine")
    expected = [reference[f"neural_w{width}_T{temperature}_affine_case{c}"] for c in CASES]
    affine_agrees(f"neural {width} affine T {temperature}", deformer, x, p, q, logits, temperature, expected)


def affine_agrees(group, deformer, x, p, q, logits, temperature, expected):
    """With plain double precision to 1e-6, and with the reference as far as its own single precision lets it."""
    ours, theirs = [], []
    for c in CASES:
        p_mean, q_mean, pq, pp = moments(p, q[c], logits, temperature)
        plain = np.einsum("ni,nij->nj", x - p_mean, np.linalg.solve(pp, pq)) + q_mean
        y = deformer.deform(q[c], temperature)
        ours.append(np.abs(y - plain))
        theirs.append(np.abs(expected[c] - plain))
        assert np.abs(y - expected[c]).max() <= theirs[-1].max() + 1e-6
    assert report(f"{group}, {len(p)} points, against float64", ours) < 1e-6
    report("  the reference against float64", theirs)


@pytest.mark.parametrize("temperature", [0.3, 0.1])
@pytest.mark.parametrize("width", [128, 1024])
def test_low_temperatures_agree_with_the_rule_in_double_precision(reference, width, temperature):
    x, p, q = given(reference)
    logits = reference[f"w{width}_logits64"].astype(np.float32).astype(np.float64)
    deformer = nm.Deformer(x, Given(p, logits))
    for c in CASES:
        y = deformer.deform(q[c], temperature)
        expected = by_the_rule(x, p, q[c], logits, temperature)
        assert report(f"neural {width} rigid T {temperature} case {c}, against float64", [np.abs(y - expected)]) < 1e-5
        if temperature == 0.3 and width == 128:
            report("  and the reference", [np.abs(y - reference[f"neural_w128_T0.3_rigid_case{c}"])])


def test_training_follows_the_reference_step_by_step(reference):
    _, p, _ = given(reference)
    trained = network(reference, p, 128, "init").further(48, 6e-4, None)
    assert report("losses of 48 steps, width 128", [np.abs(trained.losses - reference["w128_losses"])]) < 1e-6
    final = network(reference, p, 128, "final")
    pairs = zip(trained.layers, final.layers, strict=True)
    differences = [np.abs(a - b) for ours, theirs in pairs for a, b in zip(ours, theirs, strict=True)]
    assert report("parameters after them", differences) < 1e-6


def test_logits_agree_with_double_precision(reference):
    x, p, _ = given(reference)
    widths = [width for width in (128, 1024) if f"w{width}_final_W0" in reference]
    assert 128 in widths
    for width in widths:
        logits = network(reference, p, width, "final").logits(x, None)
        # What the piecewise evaluation reaches in single precision; a dense product has 1.4e-5 at the most.
        assert report(f"logits, width {width}", [np.abs(logits - reference[f"w{width}_logits64"])]) < 2.5e-5
