"""Surfaces to measure."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

Mesh = tuple[np.ndarray, np.ndarray]


@pytest.fixture
def sphere() -> Mesh:
    """A ball of radius 1, 642 vertices, closed."""
    mesh = trimesh.creation.icosphere(subdivisions=3)
    return np.asarray(mesh.vertices), np.asarray(mesh.faces, dtype=np.int64)


@pytest.fixture
def bumpy(sphere: Mesh) -> Mesh:
    """The ball, its vertices shaken: obtuse triangles too."""
    x, faces = sphere
    return x + np.random.default_rng(5).normal(size=x.shape) * 0.04, faces


@pytest.fixture
def soup(bumpy: Mesh) -> Mesh:
    """The shaken ball with each triangle on its own, then three triangles without area and a point of no triangle."""
    x, faces = bumpy
    corners = x[faces].reshape(-1, 3)
    n = len(corners)
    flat = np.array([[0.0, 0, 0], [1, 0, 0], [2, 0, 0], [0.5, 0, 0], [0.5, 0, 0], [9, 9, 9]])
    bad = np.array([[n, n + 1, n + 2], [n + 3, n + 4, n], [n + 1, n + 1, n + 2]])
    return np.concatenate([corners, flat]), np.concatenate([np.arange(n).reshape(-1, 3), bad])
