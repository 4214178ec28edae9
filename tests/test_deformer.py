"""Deformer and the one-shot function: kinds of input, progress, refusals."""

from __future__ import annotations

import threading

import numpy as np
import pytest

import neuralmls as nm

RNG = np.random.default_rng(0)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("dimension", [1, 2, 3])
def test_any_layout_of_memory_gives_the_same_result_and_is_not_changed(dtype, dimension):
    x = RNG.uniform(-1, 1, (40, dimension)).astype(dtype)
    p, q = RNG.uniform(-1, 1, (2, 5, dimension))
    expected = nm.deform(x, p, q, weights="inverse-distance")
    assert expected.dtype == dtype
    strided = np.zeros((80, 2 * dimension), dtype)
    strided[::2, ::2] = x
    frozen = x.copy()
    frozen.flags.writeable = False
    for same in (np.asfortranarray(x), strided[::2, ::2], frozen, x.astype(x.dtype.newbyteorder())):
        before = same.copy()
        assert np.array_equal(nm.deform(same, p, q, weights="inverse-distance"), expected)
        assert np.array_equal(same, before)


@pytest.mark.parametrize("size", [1e-300, 1e-150, 1e150, 1e300])
def test_classic_weights_in_one_call_do_not_depend_on_the_unit_of_length(size):
    x, p, q = RNG.uniform(-1, 1, (30, 3)), RNG.uniform(-1, 1, (5, 3)), RNG.uniform(-1, 1, (5, 3))
    here = nm.deform(x, p, q, weights="inverse-distance")
    there = nm.deform(x * size, p * size, q * size, weights="inverse-distance")
    assert np.abs(there / size - here).max() < 1e-6


def test_lists_and_integers_are_points_too():
    assert nm.deform([[0, 0], [2, 0]], [[0, 0], [2, 0]], [[0, 1], [2, 1]]).tolist() == [[0.0, 1.0], [2.0, 1.0]]


def test_any_object_with_logits_is_a_weight_function():
    class Nearest:
        control_points = np.array([[0.0], [1.0]])

        def logits(self, x, *, progress=None):
            return -100 * np.abs(x - self.control_points.T)

    y = nm.deform([[0.1], [0.9]], [[0.0], [1.0]], [[0.0], [2.0]], weights=Nearest())
    assert np.allclose(y, [[0.1], [1.9]])


@pytest.mark.parametrize("handles", ["auto", "exact", "soft", 0.5])
def test_logits_of_someones_own_are_taken_as_closely_as_those_of_the_package(handles):
    x, (p, q) = RNG.uniform(-1, 1, (20, 3)), RNG.uniform(-1, 1, (2, 5, 3))
    own = nm.InverseDistanceWeights(p, epsilon=0.01)

    class Same:
        control_points = p

        def logits(self, x, progress=None):
            return own.logits(x)

    rotations = np.full((5, 3, 3), np.nan)
    rotations[0] = [[0, -1, 0], [1, 0, 0], [0, 0, 1]]
    options = {"handles": handles, "transform": "similarity", "temperature": 0.5, "rotations": rotations}
    assert np.array_equal(nm.deform(x, p, q, weights=Same(), **options), nm.deform(x, p, q, weights=own, **options))
    with pytest.raises(nm.ArgumentError, match="relax: expected weights of this package"):
        nm.deform(x, p, q, weights=Same(), relax=0.5)


def test_maps_are_returned_when_asked():
    p = RNG.uniform(-1, 1, (5, 3))
    deformer = nm.Deformer(p, nm.InverseDistanceWeights(p), transform="rigid")
    y, maps = deformer.deform(p[:, [1, 2, 0]], return_maps=True)
    assert np.allclose(y, p[:, [1, 2, 0]])
    assert np.allclose(maps, np.eye(3)[[1, 2, 0]], atol=1e-6)


def test_a_network_is_bound_as_anything_else_with_its_logits_is():
    x, (p, q) = RNG.uniform(-1, 1, (3000, 3)), RNG.uniform(-1, 1, (2, 5, 3))
    network = nm.NeuralWeights.fit(p, bounds=[[-1] * 3, [1] * 3], width=64)

    class Same:
        control_points = p

        def logits(self, x, progress=None):
            return network.logits(x)

    for temperature in (0.3, 1.0):
        expected = nm.Deformer(x, Same()).deform(q, temperature)
        assert np.array_equal(nm.Deformer(x, network).deform(q, temperature), expected)


def test_a_tree_of_the_points_stands_in_for_them():
    x = RNG.uniform(-1, 1, (5000, 3))
    p, q = RNG.uniform(-1, 1, (2, 5, 3))
    tree = nm.PointTree(x, bounds=[[-1] * 3, [1] * 3])
    assert len(tree) == 5000
    neural = nm.NeuralWeights.fit(p, bounds=tree.bounds, width=64)
    for weights in (neural, nm.InverseDistanceWeights(p)):
        assert np.array_equal(nm.Deformer(tree, weights).deform(q), nm.Deformer(x, weights).deform(q))
    with pytest.raises(nm.ArgumentError, match="tree"):
        nm.NeuralWeights.fit(p, width=64).logits(tree)
    with pytest.raises(nm.ArgumentError, match="in one place"):
        nm.PointTree(np.zeros((4, 3)))


def test_a_frame_is_written_where_the_caller_wants_it():
    x, (p, q) = RNG.uniform(-1, 1, (50, 3)), RNG.uniform(-1, 1, (2, 5, 3))
    deformer = nm.Deformer(x, nm.InverseDistanceWeights(p))
    out = np.empty((50, 3))
    assert deformer.deform(q, out=out) is out
    assert np.array_equal(out, deformer.deform(q))
    assert deformer.deform(p, out=out).tobytes() == x.tobytes()
    for wrong in (np.empty((49, 3)), np.empty((50, 3), np.float32), np.empty((3, 50)).T, out.tolist()):
        with pytest.raises(nm.ArgumentError, match="out: expected a writeable C-contiguous float64 array"):
            deformer.deform(q, out=wrong)


def test_a_frame_with_prepared_weights_is_the_same():
    x, (p, q) = RNG.uniform(-1, 1, (50, 3)), RNG.uniform(-1, 1, (2, 5, 3))
    weights = nm.InverseDistanceWeights(p)
    deformer = nm.Deformer(x, weights)
    deformer.prepare(0.5)
    assert np.array_equal(deformer.deform(q, 0.5), nm.Deformer(x, weights).deform(q, 0.5))
    with pytest.raises(nm.ArgumentError, match="temperature"):
        deformer.prepare(0)


def test_a_point_and_no_points_are_deformed():
    p = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]
    q = np.add(p, 1)
    assert np.allclose(nm.deform([[5.0, 5.0, 5.0]], p, q), 6)
    assert nm.deform(np.empty((0, 3)), p, q).shape == (0, 3)


@pytest.mark.parametrize("m", [2, 3, 40])
def test_neural_handles_arrive_near_their_targets(m):
    p = np.random.default_rng(m).uniform(-1, 1, (m, 3))
    q = p + np.random.default_rng(m + 1).uniform(-0.2, 0.2, (m, 3))
    weights = nm.NeuralWeights.fit(p, bounds=[[-1] * 3, [1] * 3])
    assert weights.loss < 0.105
    arrived = nm.Deformer(p, weights).deform(q)
    assert np.linalg.norm(arrived - q, axis=1).max() < 0.1


def test_progress_is_told_and_can_stop():
    p, q = RNG.uniform(-1, 1, (2, 5, 3))
    told: list[float] = []
    weights = nm.NeuralWeights.fit(p, width=64, progress=told.append)
    nm.Deformer(np.zeros((10, 3)), weights, progress=told.append).deform(q, progress=told.append)
    assert told[0] == 0
    assert told[-1] == 1
    assert all(0 <= fraction <= 1 for fraction in told)

    def stop(_fraction):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        nm.NeuralWeights.fit(p, width=64, progress=stop)


def test_ctrl_c_stops_a_long_call():
    import os
    import signal

    p = RNG.uniform(-1, 1, (200, 3))
    threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT)).start()
    with pytest.raises(KeyboardInterrupt):
        nm.NeuralWeights.fit(p, steps=1_000_000)


def test_other_threads_run_during_a_long_call():
    p = RNG.uniform(-1, 1, (10, 3))
    done = threading.Event()
    ticks = 0

    def count():
        nonlocal ticks
        while not done.wait(0.001):
            ticks += 1

    counter = threading.Thread(target=count)
    counter.start()
    nm.NeuralWeights.fit(p, steps=40)
    done.set()
    counter.join()
    assert ticks > 3


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"x": [[0.0, 0.0]]}, "x: expected 3 coordinates a point, found 2"),
        ({"x": [0.0, 1.0]}, "x: expected an \\(n, d\\) array"),
        ({"x": [[np.nan, 0, 0]]}, "x: point 0 has a coordinate that is not finite"),
        ({"x": "chair"}, "x: expected an \\(n, d\\) array of numbers"),
        ({"p": np.empty((0, 3)), "q": np.empty((0, 3))}, "at least one control point"),
        ({"q": [[0.0, 0.0, 0.0]]}, "found 1 for 2"),
        ({"q": [[0.0, 0.0], [1.0, 1.0]]}, "q: expected 3 coordinates"),
        ({"p": [[1.0, 1.0, 1.0]] * 2}, "numbers 0 and 1 are in the same place"),
        ({"temperature": 0}, "temperature: expected a number above 0, found 0"),
        ({"temperature": "hot"}, "temperature: expected a number above 0, found 'hot'"),
        ({"relax": 2}, "relax: expected a number of at least 0 and at most 1, found 2"),
        ({"x": [[1j, 0, 0]]}, "x: expected an \\(n, d\\) array of numbers: they are complex"),
        (
            {"weights": nm.InverseDistanceWeights([[9.0, 0.0, 0.0]])},
            "weights: expected a weight function of the control",
        ),
        (
            {"weights": "magic"},
            "weights: expected 'neural', 'shape-aware', 'inverse-distance' or a weight function, found 'magic'",
        ),
        (
            {"weights": None},
            "weights: expected 'neural', 'shape-aware', 'inverse-distance' or a weight function, found None",
        ),
        ({"transform": "bend"}, "transform: expected rigid or similarity or affine, found 'bend'"),
        ({"transform": None}, "transform: expected a setting, found None"),
        ({"seed": -1}, "seed: expected a whole number from 0"),
        ({"seed": 0.5}, "seed: expected a whole number from 0 to 18446744073709551615, found 0.5"),
    ],
)
def test_wrong_arguments_are_refused_in_a_sentence(change, sentence):
    arguments = {"x": [[0.0, 0.0, 0.0]], "p": [[0.0, 0.0, 0.0], [1.0, 1.0, 1.0]], "q": [[0.0, 0.0, 0.0]] * 2} | change
    x, p, q = (arguments.pop(name) for name in "xpq")
    with pytest.raises(nm.ArgumentError, match=sentence):
        nm.deform(x, p, q, **arguments)


@pytest.mark.parametrize("weights", [None, "neural", np.eye(3)])
def test_what_is_no_weight_function_is_refused_in_a_sentence(weights):
    with pytest.raises(nm.ArgumentError, match=r"^weights: expected a weight function"):
        nm.Deformer([[0.0]], weights)
