"""How much a surface is bent: laws, and surfaces that are folded by known angles."""

from __future__ import annotations

import numpy as np
import pytest

from neuralmls_research.metrics import Bends


def strip(angles: list[float]) -> tuple[np.ndarray, np.ndarray]:
    """Unit squares, one after another, each turned further by an angle; long by as many as there are and one more."""
    way = np.cumsum([0.0, *angles])
    at = np.concatenate([[[0, 0]], np.cumsum(np.stack([np.cos(way), np.sin(way)], axis=1), axis=0)])
    x = np.concatenate([np.insert(at, 2, side, axis=1) for side in (0.0, 1.0)])
    n = len(at)
    first = np.arange(n - 1)
    faces = [
        np.stack(corners, axis=1) for corners in ((first, first + 1, first + n), (first + 1, first + n + 1, first + n))
    ]
    return x, np.concatenate(faces)


def test_a_strip_that_is_folded_by_known_angles():
    flat, faces = strip([0.0, 0.0, 0.0])
    folded, _ = strip([0.5, -0.3, 0.0])
    # Two edges of length 1, on an area of 4, in a box with a longest side of 4.
    assert Bends(flat, faces).bent(folded) == pytest.approx(0.8)
    assert Bends(folded, faces).bent(flat) == pytest.approx(0.8 * np.ptp(folded, axis=0).max() / 4)


def test_a_fold_to_the_other_side_counts_twice():
    up, faces = strip([0.4])
    down, _ = strip([-0.4])
    assert Bends(up, faces).bent(down) == pytest.approx(0.8 * np.ptp(up, axis=0).max() / 2)


def test_rigid_motion_and_scale_bend_nothing(bumpy):
    x, faces = bumpy
    turned = x @ np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0] + [3, -2, 1]
    assert Bends(x, faces).bent(turned) < 1e-9
    assert Bends(x, faces).bent(7 * x) < 1e-9


def test_units_and_winding_and_double_triangles_do_not_count(bumpy):
    x, faces = bumpy
    y = x * [1, 2, 1]
    bent = Bends(x, faces).bent(y)
    assert bent > 0.1
    assert Bends(9 * x, faces).bent(9 * y) == pytest.approx(bent)
    mixed = faces.copy()
    mixed[::3] = mixed[::3, ::-1]
    assert Bends(x, mixed).bent(y) == pytest.approx(bent)
    assert Bends(x, np.concatenate([faces, faces[::-1, ::-1]])).bent(y) == pytest.approx(bent)


def test_a_soup_is_bent_as_the_surface_is(bumpy):
    x, faces = bumpy
    y = x * [1, 2, 1]
    apart = np.arange(faces.size).reshape(-1, 3)
    assert Bends(x[faces].reshape(-1, 3), apart).bent(y[faces].reshape(-1, 3)) == pytest.approx(Bends(x, faces).bent(y))


def test_nothing_to_measure_is_not_bent(soup):
    assert Bends(np.zeros((3, 3)), [[0, 1, 2]]).bent(np.ones((3, 3))) == 0
    x, faces = soup
    assert np.isfinite(Bends(x, faces).bent(x * [1, 2, 1]))
