"""The benchmarks: bars, answers, limits; and a quick run of all of it with the rivals that are installed."""

from __future__ import annotations

import json
import sys

import numpy as np
import pytest

import neuralmls as nm
from benchmarks import answers, child, crossing, definitions, inputs, machine, measure, record, table
from benchmarks.__main__ import main
from benchmarks.definitions import million
from benchmarks.rivals import installed
from benchmarks.row import Outcome, Row, WrongAnswer, check


def test_bars_are_held_in_their_sense():
    assert Row("a", 1.0, "b", 10.0, bar=10).met is True
    assert Row("a", 1.0, "b", 9.9, bar=10).met is False
    assert Row("a", 3.0, "b", 1.0, sense="times", bar=3).met is True
    assert Row("a", 3.1, "b", 1.0, sense="times", bar=3).met is False
    assert Row("a", 2.9, bar=3).met is True
    assert Row("a", 4e8, bar=3.84e8, unit="B").met is False
    assert Row("a", 1.0, "b", 10.0).met is None


def test_a_wrong_answer_is_refused_and_so_is_none():
    assert "1.0e-06" in check("x", 1e-6, 1e-4)
    for error in (2e-4, float("nan"), float("inf")):
        with pytest.raises(WrongAnswer):
            check("x", error, 1e-4)


def test_contenders_take_turns_and_a_slow_one_drops_out(monkeypatch):
    turns: list[str] = []
    clock = iter(np.arange(0, 1000, 5.0))  # every call takes five seconds
    monkeypatch.setattr(measure, "perf_counter", lambda: next(clock))
    contenders = [measure.Contender(name, lambda _, n=name: turns.append(n)) for name in "ab"]
    assert measure.interleaved(contenders, 5) == {"a": 5.0, "b": 5.0}
    assert turns == ["a", "b", "a", "b"]  # ten seconds each are more than the budget


def test_what_is_prepared_is_not_timed():
    from time import sleep

    assert measure.once(measure.Contender("a", lambda given: given, lambda: sleep(0.2))) < 0.1


def test_the_naive_answer_gives_a_rigid_motion_back():
    rng = np.random.default_rng(0)
    x, p = rng.normal(size=(50, 3)), rng.normal(size=(6, 3))
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    turn *= np.sign(np.linalg.det(turn))
    w = nm.softmax(rng.normal(size=(50, 6)))
    y, rotations, defined = answers.rigid(x, p, p @ turn.T + 1, w)
    np.testing.assert_allclose(y, x @ turn.T + 1, atol=1e-12)
    np.testing.assert_allclose(rotations, np.broadcast_to(turn, (50, 3, 3)), atol=1e-12)
    assert (defined > 0).all()


def test_the_dense_path_is_the_same_function():
    x = inputs.surface(200)
    np.testing.assert_allclose(inputs.dense().logits(x), answers.logits(inputs.network(), x), atol=1e-4)


def test_every_neuron_that_changes_sign_among_a_boxs_points_is_counted():
    network, rng = inputs.network(), np.random.default_rng(0)
    (w0, b0), (w1, b1) = network.layers[:2]
    half = np.full(3, 0.05)
    for centre in rng.uniform(-0.5, 0.5, (5, 3)):
        first, second = crossing.crossing(network, centre, half)
        z0 = (centre + rng.uniform(-1, 1, (500, 3)) * half) @ w0.T + b0
        z1 = np.maximum(z0, 0) @ w1.T + b1
        for counted, z in ((first, z0), (second, z1)):
            changes = (z > 1e-5).any(axis=0) & (z < -1e-5).any(axis=0)
            assert changes.any()
            assert not (changes & ~counted).any()
            assert counted.sum() < 700


def test_a_childs_peak_is_its_own():
    held = np.ones(40_000_000)  # 320 MB in this process
    small = child.run([sys.executable, "-S", "-c", "pass"])
    large = child.run([sys.executable, "-S", "-c", "b = bytearray(b'x') * 100_000_000"])
    assert small.peak < 60e6 < held.nbytes
    assert 100e6 < large.peak < 160e6
    assert small.seconds > 0


def test_a_child_that_fails_says_why():
    with pytest.raises(RuntimeError, match="no such thing"):
        child.run([sys.executable, "-S", "-c", "raise SystemExit('no such thing')"])


def test_the_generated_mesh_has_the_chairs_surface():
    x, faces = million.mesh(200_000)
    assert 200_000 <= len(x) < 230_000
    shape = inputs.chair()

    def area(vertices: np.ndarray, triangles: np.ndarray) -> float:
        a, b, c = (vertices[triangles[:, i]] for i in range(3))
        return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum())

    assert area(x, faces) == pytest.approx(area(shape.vertices, shape.triangles))


def test_a_quick_run_checks_every_definition_and_writes_its_record(tmp_path, capsys):
    if not installed("torch"):
        print("PyTorch is not installed: the quick run is without it")
    assert main(["--quick", "--record", str(tmp_path)]) == 0
    said = capsys.readouterr().out
    assert all(f"{name} ..." in said for name in definitions.ALL)
    for rival in ("torch", "molesq"):
        assert (f"{rival}: not installed" in said) == (not installed(rival))
    (path,) = tmp_path.iterdir()
    found = json.loads(path.read_text())
    assert path.stat().st_size < 50_000
    assert found["machine"]["threads"] == machine.THREADS
    assert all(value > 1e8 for value in found["limits"].values())
    assert all(row["ours"] > 0 and row["met"] is None for row in found["rows"])  # bars are for the full sizes
    assert len(found["answers"]) > 20
    assert {row["threads"] for row in found["series"]["how cost grows (medians)"]} == {1, 2}


def test_a_wrong_answer_ends_the_run_with_1(monkeypatch, capsys):
    right = nm.NeuralWeights.logits
    monkeypatch.setattr(nm.NeuralWeights, "logits", lambda self, x, **how: right(self, x, **how) + np.float32(1e-3))
    assert main(["--quick", "--only", "logits"]) == 1
    assert "wrong answer in logits" in capsys.readouterr().out


def test_a_missed_bar_is_printed_and_ends_the_run_with_0(monkeypatch, capsys):
    missed = Outcome("t", [Row("a slow thing", 1.0, "a rival", 2.0, bar=4.0)], [], [])
    monkeypatch.setitem(definitions.ALL, "training", lambda _: missed)
    assert main(["--quick", "--only", "training"]) == 0
    said = capsys.readouterr().out
    assert "missed" in said
    assert "at least 4x" in said


def test_amounts_have_three_digits():
    assert table.amount(0.01234, "s") == "12.3 ms"
    assert table.amount(384e6, "B") == "384 MB"
    assert table.times(349.6) == "350x"
    assert record.rounded(1.23456e-5) == 1.235e-5
