"""The inverse of maps, their Jacobians, and grids."""

from __future__ import annotations

import re

import numpy as np
import pytest

import neuralmls as nm

RANDOM = np.random.default_rng(4)
P = RANDOM.uniform(-1, 1, (10, 3))
X = RANDOM.uniform(-1.2, 1.2, (3000, 3))


def fitted(points: np.ndarray = P, by: float = 0.05, **settings: object) -> nm.Map:
    targets = points + by * np.random.default_rng(0).uniform(-1, 1, points.shape)
    kinds = {"weights": "inverse-distance"} | settings
    return nm.Session(
        nm.ControlPoints(points, targets), frame=[[-1] * points.shape[1], [1] * points.shape[1]], **kinds
    ).fit()  # type: ignore[arg-type]


@pytest.mark.parametrize("dimension", [1, 2, 3])
@pytest.mark.parametrize("transform", ["rigid", "similarity", "affine"])
@pytest.mark.parametrize("settings", [{}, {"weights": "neural", "width": 128}])
def test_what_was_moved_comes_back(dimension, transform, settings):
    points = np.c_[np.linspace(-0.9, 0.9, 10), P[:, 1:]][:, :dimension]
    map = fitted(points, 0.01, transform=transform, **settings)
    x = 0.7 * X[:, :dimension]  # not far beyond them, where affine maps fold
    assert (np.linalg.det(map.jacobian(x)) > 0).all()
    y = map.at(x)
    # The box has a side of 2. `at` itself has its logits, and with them places, in single precision.
    bound = 2e-6 if settings else 2e-8
    assert np.abs(map.inverse(y) - x).max() < bound
    assert np.abs(map.at(map.inverse(x)) - x).max() < bound


def test_the_jacobian_is_what_differences_say():
    map = fitted()
    x, step = X[np.linalg.norm(X[:, None] - P, axis=2).min(axis=1) > 0.1], 1e-3
    found = map.jacobian(x)
    assert found.shape == (len(x), 3, 3)
    beside = [(map.at(x + step * axis) - map.at(x - step * axis)) / (2 * step) for axis in np.eye(3)]
    assert np.abs(found - np.stack(beside, axis=-1)).max() < 1e-3


def test_grids_keep_their_shape():
    map = fitted(P[:, :2])
    grid = np.stack(np.meshgrid(np.linspace(-1, 1, 5), np.linspace(-1, 1, 4), indexing="ij"), axis=-1)
    rows = grid.reshape(-1, 2)
    for call in (map.at, map.inverse, map.jacobian):
        assert np.array_equal(call(grid).reshape(20, -1), call(rows).reshape(20, -1))
    assert map.jacobian(grid).shape == (5, 4, 2, 2)
    back, found, maps = map.inverse(grid.astype(np.float32), return_found=True, return_maps=True)
    assert (back.shape, back.dtype, found.shape, maps.shape) == ((5, 4, 2), np.float32, (5, 4), (5, 4, 2, 2))
    assert found.all()
    volume = np.zeros((2, 3, 4, 3))
    assert fitted().at(volume).shape == fitted().inverse(volume).shape == volume.shape
    assert fitted().inverse(np.zeros((0, 3))).shape == (0, 3)


def test_a_single_place_and_others_are_refused_as_ever():
    map = fitted()
    for call in (map.at, map.inverse, map.jacobian):
        for points in ([0.0, 0, 0], np.zeros((2, 2, 2)), [[1.0], [1, 2]]):
            with pytest.raises(nm.ArgumentError):
                call(points)


def test_where_a_map_folds_places_are_named_or_masked():
    # Two control points that change places, and others around that stay.
    points = np.array([[-1.0], [-0.2], [0.2], [1]])
    targets = points * [[1], [-1], [-1], [1]]
    map = nm.Session(nm.ControlPoints(points, targets), weights="inverse-distance", transform="affine").fit()
    assert (map.jacobian(np.linspace(-1, 1, 101)[:, None]) < 0).any()
    flat = nm.Session(
        nm.ControlPoints([[-1.0], [1]], [[0.0], [0]]), weights="inverse-distance", transform="affine"
    ).fit()
    with pytest.raises(nm.ArgumentError) as refused:
        flat.inverse([[0.25], [0.5]])
    assert re.search(r"goes to 2 of 2, as where the map folds; the first is point 0, \(0.25\)$", str(refused.value))
    x, found = flat.inverse([[0.25], [0.5]], return_found=True)
    assert found.tolist() == [False, False]
    assert np.isfinite(x).all()


def test_unmoved_maps_give_the_points_back_bit_for_bit():
    map = fitted(by=0)
    assert np.array_equal(map.inverse(X), X)
    assert np.array_equal(map.jacobian(X[:2]), [np.eye(3)] * 2)


def test_a_relaxed_map_is_refused_in_a_sentence():
    session = nm.Session(nm.ControlPoints(P, P + 0.1), weights="inverse-distance", relax=0.5)
    map = session.fit(X[:200])
    for call in (map.inverse, map.jacobian):
        with pytest.raises(nm.ArgumentError, match="relax: a map with an elastic finish"):
            call([[0.0, 0, 0]])
    assert map.with_session(map.session.replace(relax=0)).inverse([[0.0, 0, 0]]).shape == (1, 3)


def test_progress_is_told_and_stops():
    done: list[float] = []
    map = fitted()
    map.inverse(X, progress=done.append)
    assert done == sorted(done)
    assert done[-1] == 1

    class Stop(Exception):
        pass

    def stop(_: float) -> None:
        raise Stop

    with pytest.raises(Stop):
        map.inverse(X, progress=stop)
