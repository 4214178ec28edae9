"""Weight functions: what they say, saving and loading, refusals."""

from __future__ import annotations

import copy
import json
import pickle

import numpy as np
import pytest

import neuralmls as nm

P = np.array([[-0.8, -0.9, 0.1], [0.7, -0.8, 0.2], [-0.6, 0.9, -0.3], [0.5, 0.4, 0.9]])
X = np.random.default_rng(0).uniform(-1, 1, (30, 3))


@pytest.fixture(scope="module")
def neural():
    return nm.NeuralWeights.fit(P, width=64)


@pytest.mark.parametrize(("alpha", "epsilon"), [(0.5, 0.0), (1.0, 0.0), (2.0, 0.1)])
def test_classic_weights_are_the_formula(alpha, epsilon):
    squared = ((X[:, None] - P) ** 2).sum(axis=2)
    expected = 1 / (squared**alpha + epsilon)
    expected /= expected.sum(axis=1, keepdims=True)
    weights = nm.InverseDistanceWeights(P, alpha=alpha, epsilon=epsilon, bounds=[[-1] * 3, [1] * 3])
    assert np.abs(nm.softmax(weights.logits(X)) - expected).max() < 1e-6


def test_with_bounds_epsilon_means_the_same_at_any_size():
    small = nm.InverseDistanceWeights(P, epsilon=0.1, bounds=[[-1] * 3, [1] * 3])
    large = nm.InverseDistanceWeights(1000 * P, epsilon=0.1, bounds=[[-1000] * 3, [1000] * 3])
    assert np.allclose(nm.softmax(small.logits(X)), nm.softmax(large.logits(1000 * X)), atol=1e-6)


@pytest.mark.parametrize("size", [1e-200, 1e200])
def test_classic_weights_without_bounds_are_the_same_at_any_size(size):
    expected = nm.softmax(nm.InverseDistanceWeights(P).logits(X))
    found = nm.softmax(nm.InverseDistanceWeights(size * P).logits(size * X))
    assert np.abs(found - expected).max() < 1e-6


def test_without_bounds_epsilon_counts_in_halves_of_the_longest_side_of_the_control_points_box():
    weights = nm.InverseDistanceWeights([[0.0], [8.0]], epsilon=1.0)
    assert weights.logits([[2.0]])[0, 0] == pytest.approx(-np.log(0.5**2 + 1))
    boxed = nm.InverseDistanceWeights([[0.0], [8.0]], epsilon=1.0, bounds=[[0.0], [8.0]])
    assert np.array_equal(weights.logits([[2.0]]), boxed.logits([[2.0]]))


@pytest.mark.parametrize("logits", [[], 1.0, None, np.empty((3, 0)), [[1.0], [1.0, 2.0]], "logits"])
def test_softmax_refuses_what_has_no_rows_of_numbers(logits):
    with pytest.raises(nm.ArgumentError, match=r"^logits: expected an \(n, m\) array"):
        nm.softmax(logits)


def test_softmax_takes_infinite_logits_and_small_temperatures():
    w = nm.softmax([[0.0, np.inf, 3.0], [0.0, -1.0, -2.0]], 1e-3)
    assert w.tolist() == [[0.0, 1.0, 0.0], [1.0, 0.0, 0.0]]


def test_every_control_point_owns_its_place(neural):
    assert nm.softmax(neural.logits(P)).diagonal().min() >= 0.9
    assert neural.steps == len(neural.losses) < 2000
    assert neural.loss < neural.losses[0]


def test_saved_weights_are_loaded_as_they_were(neural, tmp_path):
    neural.save(tmp_path / "chair.weights")
    loaded = nm.NeuralWeights.load(tmp_path / "chair.weights")
    assert np.array_equal(loaded.logits(X), neural.logits(X))
    assert np.array_equal(loaded.control_points, P)
    assert (loaded.loss, loaded.steps) == (neural.loss, neural.steps)
    fourier = nm.NeuralWeights.fit(P, width=32, fourier_sigma=0.5)
    fourier.save(tmp_path / "fourier.weights")
    assert np.array_equal(nm.NeuralWeights.load(tmp_path / "fourier.weights").logits(X), fourier.logits(X))
    classic = nm.InverseDistanceWeights(P, alpha=2, epsilon=0.1)
    classic.save(tmp_path / "classic.weights")
    found = nm.InverseDistanceWeights.load(tmp_path / "classic.weights")
    assert (found.alpha, found.epsilon) == (2, 0.1)
    assert np.array_equal(found.logits(X), classic.logits(X))
    with pytest.raises(nm.FileError, match="expected neural weights, found inverse-distance ones"):
        nm.NeuralWeights.load(tmp_path / "classic.weights")


def test_saved_weights_are_safetensors_that_others_read(neural, tmp_path):
    numpy = pytest.importorskip("safetensors.numpy")
    neural.save(tmp_path / "chair.weights")
    arrays = numpy.load_file(tmp_path / "chair.weights")
    assert {name: array.shape for name, array in arrays.items() if name.startswith("weight")} == {
        "weight0": (64, 3),
        "weight1": (64, 64),
        "weight2": (4, 64),
    }
    assert np.array_equal(arrays["control_points"], P)


@pytest.fixture
def changed(neural, tmp_path):
    """Save the weights with some arrays replaced."""
    numpy = pytest.importorskip("safetensors.numpy")
    neural.save(tmp_path / "whole")
    arrays = numpy.load_file(tmp_path / "whole")

    def save(version=1, name="neuralmls-map", **others):
        metadata = {name: json.dumps({"version": version, "weights": "neural"})}
        numpy.save_file({**arrays, **others}, tmp_path / "changed", metadata=metadata)
        return tmp_path / "changed"

    return save


def test_other_files_are_refused_in_a_sentence(neural, tmp_path):
    with pytest.raises(nm.FileError, match=r"none: there is no such file"):
        nm.NeuralWeights.load(tmp_path / "none")
    (tmp_path / "text").write_text("v 0 0 0\n")
    np.savez(tmp_path / "arrays.npz", a=np.zeros(3))
    neural.save(tmp_path / "whole")
    whole = (tmp_path / "whole").read_bytes()
    (tmp_path / "half").write_bytes(whole[: len(whole) // 2])
    (tmp_path / "bomb").write_bytes((2**62).to_bytes(8, "little") + b"{}")
    for name in ("text", "arrays.npz", "half", "bomb"):
        with pytest.raises(nm.FileError, match=f"{name}: this is no map that was saved by NeuralMLS") as raised:
            nm.NeuralWeights.load(tmp_path / name)
        assert "\n" not in str(raised.value)


@pytest.mark.parametrize(
    ("arrays", "words"),
    [
        ({"bias1": np.zeros(3, np.float32)}, "weight1: expected F32"),
        ({"control_points": P[:2]}, "weight2: expected F32"),
        ({"weight0": np.zeros((3, 64), np.float32)}, r"weight0: expected F32 \[64, 3\], found F32 \[3, 64\]"),
        ({"weight0": np.zeros((64, 3), np.float64)}, r"weight0: expected F32 \[64, 3\], found F64 \[64, 3\]"),
        ({"weight2": np.full((4, 64), np.nan, np.float32)}, "layer 2: expected finite numbers"),
        ({"half": np.zeros(1)}, "expected a finite frame with a size above 0"),
        ({"half": np.ones((1, 1))}, "half: expected F64"),
    ],
)
def test_arrays_that_do_not_fit_are_refused_by_name(changed, arrays, words):
    with pytest.raises(nm.FileError, match=f"changed: this is no map that was saved by NeuralMLS: {words}"):
        nm.NeuralWeights.load(changed(**arrays))


def test_files_of_another_format_or_version_are_refused(changed):
    with pytest.raises(nm.FileError, match="its metadata has no neuralmls-map"):
        nm.NeuralWeights.load(changed(name="other"))
    with pytest.raises(nm.FileError, match="version: expected 1, found 2"):
        nm.NeuralWeights.load(changed(version=2))


def test_weights_and_what_is_bound_to_them_can_be_pickled_and_copied(neural):
    q = P + 0.1
    for weights in (neural, nm.InverseDistanceWeights(P)):
        deformer, exact = nm.Deformer(X, weights), nm.ExactHandles(weights)
        for again in (pickle.loads(pickle.dumps(deformer)), copy.deepcopy(deformer)):
            assert np.array_equal(again.deform(q[::-1]), deformer.deform(q[::-1]))
        assert np.array_equal(pickle.loads(pickle.dumps(weights)).logits(X), weights.logits(X))
        assert np.array_equal(pickle.loads(pickle.dumps(exact)).aim(q).targets, exact.aim(q).targets)


@pytest.mark.parametrize(
    ("call", "sentence"),
    [
        (lambda: nm.InverseDistanceWeights(P, alpha=0), "alpha: expected a number above 0"),
        (lambda: nm.InverseDistanceWeights(P, epsilon=-1), "epsilon: expected a number of at least 0"),
        (lambda: nm.InverseDistanceWeights(np.empty((0, 3))), "control_points: expected at least one"),
        (lambda: nm.NeuralWeights.fit(P, width=0), "width: expected a whole number from 1 to 16384, found 0"),
        (lambda: nm.NeuralWeights.fit(P, steps=0), "steps: expected a whole number from 1"),
        (lambda: nm.NeuralWeights.fit(P, rate=np.inf), "rate: expected a number above 0, found Infinity"),
        (lambda: nm.NeuralWeights.fit(P, fourier_sigma=0), "fourier_sigma: expected a number above 0"),
        (lambda: nm.NeuralWeights.fit(np.empty((0, 3))), "expected at least one, found none"),
        (lambda: nm.NeuralWeights.fit(np.arange(3003.0).reshape(-1, 3)), "found 1001"),
        (lambda: nm.NeuralWeights.fit(P, bounds=[[0] * 3, [0] * 3]), "bounds: all points are in one place"),
        (lambda: nm.NeuralWeights.fit(P, bounds=[[1] * 3, [0] * 3]), "bounds: expected two rows"),
    ],
)
def test_wrong_arguments_are_refused_in_a_sentence(call, sentence):
    with pytest.raises(nm.ArgumentError, match=sentence):
        call()
