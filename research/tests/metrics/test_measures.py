"""All measures of a deformation at once."""

from __future__ import annotations

from dataclasses import asdict

import numpy as np
import pytest

import neuralmls as nm
from neuralmls_research.metrics import handle_errors, measure


def test_lengths_are_in_halves_of_the_longest_side(bumpy):
    x, faces = bumpy
    p, q = x[:3], x[:3] + 0.1
    y = x + 0.05 * np.sin(3 * x[:, ::-1])
    one, other = measure(x, y, faces, p, q), measure(7 * x + 5, 7 * y + 5, faces, 7 * p + 5, 7 * q + 5)
    for (name, a), (_, b) in zip(flat(asdict(one)), flat(asdict(other)), strict=True):
        assert a is b is None or a == pytest.approx(b, rel=1e-6), name


def test_control_points_between_vertices_are_met_at_the_point_and_not_at_the_vertex():
    x = np.array([[-1.0, 0, 0], [1, 0, 0], [0, 1, 0]])
    p = np.array([[-0.8, 0, 0]])
    found = measure(x, x + 1, None, p, p + 1, f=lambda z: z + 1)
    assert (found.at_vertices, found.at_points, found.folded) == (pytest.approx(0.2), 0.0, 0)
    assert found.curvature is found.strain is found.flips is found.volume is None


def test_no_map_of_space_gives_no_figures_of_one(bumpy):
    x, faces = bumpy
    found = measure(x, x, faces, x[:2], x[:2])
    assert (found.at_points, found.folded, found.volume) == (None, None, 0.0)


@pytest.mark.parametrize("dimension", [1, 2])
def test_lines_and_planes_are_measured_where_they_can_be(dimension):
    x = np.random.default_rng(0).normal(size=(20, dimension))
    found = measure(x, x, None, x[:2], x[:2], f=lambda z: z)
    assert (found.at_vertices, found.at_points, found.folded) == (0, 0, 0)


def test_targets_that_do_not_fit_are_refused():
    with pytest.raises(nm.ArgumentError, match="a target for each control point"):
        handle_errors(np.eye(3), np.eye(3), np.eye(3), np.eye(3)[:2])
    with pytest.raises(nm.ArgumentError, match="q: expected 3 coordinates"):
        measure(np.eye(3), np.eye(3), None, np.eye(3), [[0.0, 1.0]])


def flat(content, before=""):
    for name, value in content.items():
        if isinstance(value, dict):
            yield from flat(value, f"{before}{name}.")
        else:
            yield f"{before}{name}", value
