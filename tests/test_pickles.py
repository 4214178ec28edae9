"""What is kept can be pickled, copied, and sent to other processes, and is then the same."""

from __future__ import annotations

import copy
import multiprocessing
import pickle
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import neuralmls as nm

RNG = np.random.default_rng(0)
P = RNG.uniform(-1, 1, (5, 3))
Q = P + RNG.uniform(-0.2, 0.2, P.shape)
X = RNG.uniform(-1, 1, (200, 3))

POINTS = nm.ControlPoints(
    P,
    Q,
    ["a", "b", "c", "d e", "\u00fc"],
    [None, nm.Orientation((1, 2, 3), 40, 1.5), None, None, None],
    [1, 1, 0.5, 0, 1],
)


def session(weights: str = "neural", **parameters: Any) -> nm.Session:
    settings = {"transform": "similarity", "temperature": 0.7, "handles": 0.5, "frame": [[-1.5] * 3, [1.5] * 3]}
    return nm.Session(POINTS, weights=weights, **settings, **parameters)  # type: ignore[arg-type]


@pytest.fixture(scope="module")
def kept() -> dict[str, Any]:
    """One of each kind of what is kept."""
    neural = nm.NeuralWeights.fit(P, width=64)
    classic = nm.InverseDistanceWeights(P, alpha=2, epsilon=0.1)
    aware = nm.ShapeAwareWeights.fit(P, X)
    return {
        "points": POINTS,
        "orientation": POINTS.orientations[1],
        "session": session(width=64, seed=3),
        "map": session(width=64).fit(X),
        "map of a shape": session("shape-aware").fit(X),
        "map by distance": session("inverse-distance", alpha=2, epsilon=0.01).fit(X),
        "neural": neural,
        "shape-aware": aware,
        "classic": classic,
        "deformer": nm.Deformer(X, neural, transform="affine"),
        "deformer of floats": nm.Deformer(X.astype(np.float32), classic),
        "handles": nm.ExactHandles(aware, transform="similarity"),
    }


def told(value: Any) -> list[Any]:
    """All that can be asked of it."""
    if isinstance(value, nm.ControlPoints):
        oriented = [told(orientation) for orientation in value.orientations if orientation is not None]
        return [value.names, value.sources.tolist(), value.targets.tolist(), value.weights.tolist(), oriented]
    if isinstance(value, nm.Orientation):
        return [value.axis, value.degrees, value.scale, value.matrix.tolist()]
    if isinstance(value, nm.Session):
        assert value.frame is not None
        return [told(value.points), value.settings, value.has_settings, value.frame.tolist(), value.notes]
    if isinstance(value, nm.Map):
        return [told(value.session), value.at(X).tolist(), told(value.weights), value.report().warnings]
    if isinstance(value, nm.Weights):
        return [type(value), value.control_points.tolist(), value.logits(X).tolist()]
    if isinstance(value, nm.Deformer):
        result = value.deform(Q, 0.5, adherence=1)
        return [result.dtype, result.tolist()]
    assert isinstance(value, nm.ExactHandles)
    return value.aim(Q).targets.tolist()


NAMES = (
    "points",
    "orientation",
    "session",
    "map",
    "map of a shape",
    "map by distance",
    "neural",
    "shape-aware",
    "classic",
)
BOUND = ("deformer", "deformer of floats", "handles")


@pytest.mark.parametrize("again", [copy.copy, copy.deepcopy, lambda value: pickle.loads(pickle.dumps(value))])
@pytest.mark.parametrize("name", NAMES + BOUND)
def test_pickled_and_copied_it_is_the_same(kept: dict[str, Any], name: str, again: Callable[[Any], Any]) -> None:
    assert told(again(kept[name])) == told(kept[name])


def test_a_copy_of_a_session_read_from_a_file_has_its_notes_and_the_keys_of_others(tmp_path: Any) -> None:
    point = '{"name": "a", "position": [0], "tag": 1}'
    head = '"format": "neuralmls-control-points", "version": 2'
    text = f'{{{head}, "mine": [1], "control_points": [{point}]}}'
    (tmp_path / "mine.json").write_text(text)
    read = nm.Session.read(tmp_path / "mine.json")
    pickle.loads(pickle.dumps(read)).write(tmp_path / "again.json")
    written = (tmp_path / "again.json").read_text()
    assert '"mine"' in written
    assert '"tag"' in written


@pytest.mark.parametrize("method", ["fork", "spawn", "forkserver"])
def test_sent_to_another_process_it_is_the_same_there(kept: dict[str, Any], method: str) -> None:
    if method not in multiprocessing.get_all_start_methods():
        pytest.skip(f"this system has no {method}")
    map, deformer = kept["map"], kept["deformer"]
    before = map.at(X), deformer.deform(Q, 0.5)
    with multiprocessing.get_context(method).Pool(1) as pool:
        sent = [pool.apply_async(map.at, (X,)), pool.apply_async(deformer.deform, (Q, 0.5))]
        there = [pool.apply_async(copy.copy, (kept[name],)) for name in NAMES + BOUND]
        for here, result in zip(before, sent, strict=True):
            assert np.array_equal(result.get(120), here)
        for name, result in zip(NAMES + BOUND, there, strict=True):
            assert told(result.get(120)) == told(kept[name])
