"""What is fitted and bound works in every process and thread: forked, spawned, or several at once."""

from __future__ import annotations

import multiprocessing
import os
import threading

import numpy as np
import pytest

import neuralmls as nm

# So many points that every step is shared by threads.
X = np.random.default_rng(0).normal(size=(20_000, 3))
P = X[:6].copy()
Q = P + 0.1 * np.sin(7 * P)
BOX = np.stack([X.min(axis=0), X.max(axis=0)])


def deformed() -> np.ndarray:
    """All that threads do: a tree, training, piecewise evaluation, packed weights, a frame."""
    weights = nm.NeuralWeights.fit(P, bounds=BOX, width=64, steps=20)
    return nm.Deformer(X, weights).deform(Q)


def child(expected: np.ndarray) -> None:
    # Its exit code is what the parent looks at.
    os._exit(0 if np.array_equal(deformed(), expected) else 1)


@pytest.mark.parametrize("method", ["fork", "spawn", "forkserver"])
def test_four_processes_give_the_answer_of_the_one_that_starts_them(method):
    if method not in multiprocessing.get_all_start_methods():
        pytest.skip(f"this system has no {method}")
    expected = deformed()  # The parent has used its threads.
    context = multiprocessing.get_context(method)
    children = [context.Process(target=child, args=(expected,)) for _ in range(4)]
    for process in children:
        process.start()
    for process in children:
        process.join(120)
        hangs = process.is_alive()
        if hangs:
            process.kill()
        assert not hangs, f"a child of {method} hangs"
    assert [process.exitcode for process in children] == [0] * 4


def test_a_forked_child_goes_on_with_what_its_parent_bound():
    if "fork" not in multiprocessing.get_all_start_methods():
        pytest.skip("this system has no fork")
    deformer = nm.Deformer(X, nm.NeuralWeights.fit(P, bounds=BOX, width=64, steps=20))
    expected = deformer.deform(Q)

    def again() -> None:
        same = np.array_equal(deformer.deform(Q), expected) and deformer.deform(Q, 0.5).shape == X.shape
        os._exit(0 if same else 1)

    process = multiprocessing.get_context("fork").Process(target=again)
    process.start()
    process.join(120)
    if process.is_alive():
        process.kill()
    assert process.exitcode == 0


def test_eight_threads_share_a_deformer():
    deformer = nm.Deformer(X, nm.InverseDistanceWeights(P))
    temperatures = [0.3, 1.0, 2.0]
    expected = {t: deformer.deform(Q, t) for t in temperatures}
    wrong: list[str] = []

    def work(number: int) -> None:
        try:
            for turn in range(12):
                t = temperatures[(number + turn) % 3]
                if not np.array_equal(deformer.deform(Q, t), expected[t]):
                    wrong.append(f"thread {number}, T = {t}")
        except Exception as error:
            wrong.append(f"thread {number}: {error}")

    threads = [threading.Thread(target=work, args=(number,)) for number in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(120)
    assert not any(thread.is_alive() for thread in threads)
    assert wrong == []
