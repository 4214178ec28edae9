"""The elastic finish: what it keeps, what it needs, and that a saved map has it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import neuralmls as nm


def bar() -> tuple[np.ndarray, np.ndarray]:
    """A bar of square rings along the first axis."""
    ring = np.array([[-0.1, -0.15], [0.1, -0.15], [0.1, 0.15], [-0.1, 0.15]])
    x = np.concatenate([np.column_stack([np.full(4, along), ring]) for along in np.linspace(-1, 1, 40)])
    a = 4 * np.arange(39)[:, None] + np.arange(4)
    b = 4 * np.arange(39)[:, None] + (np.arange(4) + 1) % 4
    faces = np.concatenate([np.stack(f, axis=2).reshape(-1, 3) for f in ([a, b, b + 4], [a, b + 4, a + 4])])
    return x, faces


X, FACES = bar()
P = X[[0, 60, 80, 110, 158]]
Q = P + np.column_stack([-0.2 * P[:, 0] ** 2, 0.3 * P[:, 0] * P[:, 2], 0.4 * P[:, 0] ** 2])


def fitted(weights: str = "inverse-distance", relax: float = 1.0, **said: object) -> nm.Map:
    session = nm.Session(nm.ControlPoints(P, Q), weights=weights, handles="exact", relax=relax, **said)  # type: ignore[arg-type]
    return session.fit(X, faces=FACES)


@pytest.fixture(scope="module")
def map() -> nm.Map:
    return fitted()


@pytest.mark.parametrize("weights", ["neural", "shape-aware", "inverse-distance"])
def test_control_points_arrive_and_what_is_between_moves_otherwise(weights: str) -> None:
    map = fitted(weights)
    np.testing.assert_allclose(map.at(P), Q, atol=1e-6)
    plain = map.with_session(map.session.replace(relax=0.0))
    assert np.abs(map.at(X) - plain.at(X)).max() > 1e-3
    assert max(map.report().distance_to_target) < 1e-6


def test_at_rest_nothing_moves_and_a_rigid_motion_is_that_motion(map: nm.Map) -> None:
    assert np.array_equal(map.moved(nm.ControlPoints(P)).at(X), X)
    turn = np.array([[0.6, -0.8, 0], [0.8, 0.6, 0], [0, 0, 1.0]])
    moved = map.moved(nm.ControlPoints(P, P @ turn.T + 0.3))
    y, maps = moved.deform(X, return_maps=True)
    np.testing.assert_allclose(y, X @ turn.T + 0.3, atol=1e-9)
    np.testing.assert_allclose(maps, np.broadcast_to(turn, maps.shape), atol=1e-9)


def test_far_from_the_origin_it_does_the_same(map: nm.Map) -> None:
    far = np.array([5e5, -3e6, 1e4])
    session = nm.Session(nm.ControlPoints(P + far, Q + far), weights="inverse-distance", handles="exact", relax=1.0)
    np.testing.assert_allclose(session.fit(X + far, faces=FACES).at(X + far) - far, map.at(X), atol=1e-4)


def test_links_keep_their_lengths_better(map: nm.Map) -> None:
    edges = np.unique(np.sort(FACES[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1), axis=0)

    def stretch(y: np.ndarray) -> float:
        length = np.linalg.norm(y[edges[:, 0]] - y[edges[:, 1]], axis=1)
        return float(np.abs(np.log(length / np.linalg.norm(X[edges[:, 0]] - X[edges[:, 1]], axis=1))).mean())

    plain = map.with_session(map.session.replace(relax=0.0))
    assert stretch(map.at(X)) < 0.9 * stretch(plain.at(X))


def test_a_saved_map_has_it(map: nm.Map, tmp_path: Path) -> None:
    map.save(tmp_path / "a.map")
    again = nm.Map.load(tmp_path / "a.map")
    again.save(tmp_path / "b.map")
    assert (tmp_path / "a.map").read_bytes() == (tmp_path / "b.map").read_bytes()
    assert np.array_equal(again.at(X), map.at(X))
    half = again.with_session(again.session.replace(relax=0.5)).at(X)
    plain = again.with_session(again.session.replace(relax=0.0)).at(X)
    np.testing.assert_allclose(half, (plain + map.at(X)) / 2, atol=1e-12)


def test_what_was_fitted_without_is_refused() -> None:
    map = fitted(relax=0.0)
    with pytest.raises(nm.ArgumentError, match="fitted without, and knows no shape"):
        map.with_session(map.session.replace(relax=0.5))
    with pytest.raises(nm.ArgumentError, match="relax needs at least one shape"):
        nm.Session(nm.ControlPoints(P), weights="inverse-distance", relax=0.5).fit()
    with pytest.raises(nm.ArgumentError, match="a line has no stiffness"):
        nm.Session(nm.ControlPoints([[0.0], [1.0]]), weights="inverse-distance", relax=0.5).fit([[0.0], [1.0]])


def test_points_bound_without_it_are_refused(map: nm.Map) -> None:
    bound = nm.Deformer(X, map.weights)
    with pytest.raises(nm.ArgumentError, match="the points are not bound to this elastic shape"):
        map.frame(bound)


def test_it_is_looked_at(map: nm.Map) -> None:
    plain = map.with_session(map.session.replace(relax=0.0))
    assert not np.array_equal(map.look(X, FACES).positions, plain.look(X, FACES).positions)


@pytest.mark.parametrize("faces", [[[0, 1, 9999]], [[0, 1]]])
def test_faces_that_do_not_fit_are_refused(faces: list[list[int]]) -> None:
    session = nm.Session(nm.ControlPoints(P), weights="inverse-distance", relax=1.0)
    with pytest.raises(nm.ArgumentError, match="faces"):
        session.fit(X, faces=faces)
    with pytest.raises(nm.ArgumentError, match="beside one array of points"):
        session.fit(X, X, faces=FACES)
