"""Singular values, Dirichlet energy, stretch: laws, and what they leave out."""

from __future__ import annotations

import numpy as np
import pytest

from neuralmls_research.metrics import singular_values, strain
from neuralmls_research.metrics.triangles import normals, weighted_median


def test_rigid_motion_is_no_strain(bumpy):
    x, faces = bumpy
    turned = x @ np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0] + [3, -2, 1]
    found = strain(x, turned, faces)
    assert found.dirichlet_mean == pytest.approx(4, abs=1e-9)
    assert found.dirichlet_median == pytest.approx(4, abs=1e-9)
    assert max(found.area_mean, found.edge_mean) < 1e-9


def test_singular_values_are_those_of_the_map_in_each_plane(bumpy):
    x, faces = bumpy
    linear = np.random.default_rng(2).normal(size=(3, 3))
    expected = []
    for corners in x[faces]:
        basis = np.linalg.qr((corners[1:] - corners[0]).T)[0]
        expected.append(np.linalg.svd(linear @ basis, compute_uv=False))
    np.testing.assert_allclose(singular_values(x, x @ linear.T, faces), expected, rtol=1e-7, atol=1e-9)


def test_areas_are_those_of_libigl(bumpy):
    igl = pytest.importorskip("igl")
    x, faces = bumpy
    np.testing.assert_allclose(np.linalg.norm(normals(x, faces), axis=1), igl.doublearea(x, faces), rtol=1e-10)
    stretched = x * [1, 2, 3]
    before, after = igl.doublearea(x, faces), igl.doublearea(stretched, faces)
    expected = np.average(abs(after / before - 1), weights=before)
    assert strain(x, stretched, faces).area_mean == pytest.approx(expected)


def test_uniform_scale(bumpy):
    x, faces = bumpy
    found = strain(x, 3 * x, faces)
    assert found.dirichlet_mean == pytest.approx(2 * (9 + 1 / 9))
    assert found.area_median == pytest.approx(8)
    assert found.edge_median == pytest.approx(2)


def test_needles_and_collapsed_triangles_are_left_out_and_counted(soup):
    x, faces = soup
    y = x.copy()
    y[1] = y[0]  # the first triangle collapses
    found = strain(x, y, faces)
    assert (found.degenerate, found.collapsed) == (3, 1)
    assert np.isfinite([found.dirichlet_mean, found.area_mean, found.edge_mean]).all()
    assert np.isnan(singular_values(x, y, faces)[-3:]).all()


def test_nothing_to_measure_is_nan():
    found = strain(np.zeros((3, 3)), np.zeros((3, 3)), [[0, 1, 2]])
    assert np.isnan([found.dirichlet_mean, found.dirichlet_median, found.area_mean, found.edge_median]).all()


def test_half_of_the_weight_lies_below_the_weighted_median():
    assert weighted_median(np.array([3.0, 1.0, 2.0]), np.array([1.0, 1.0, 1.0])) == 2
    assert weighted_median(np.array([3.0, 1.0, 2.0]), np.array([5.0, 1.0, 1.0])) == 3
