"""The bootstrap, where the answer is known; and what seeds change."""

from __future__ import annotations

from itertools import pairwise
from math import comb, exp, log, sqrt

import numpy as np
import pytest

from neuralmls.errors import ArgumentError
from neuralmls_research.experiments.bootstrap import ratio
from neuralmls_research.experiments.seeds import OtherOrder, other_orders


def test_poses_of_one_file_give_the_binomial_interval():
    # Half of 20 poses have the ratio 1, half 2: a resample's is 1 + B / 20, with B binomial (20, 1/2).
    errors = np.tile([1.0, 2.0], 10)
    found = ratio([errors], [np.ones((1, 20))])
    below = np.cumsum([comb(20, k) / 2**20 for k in range(21)])
    quantiles = [int(np.searchsorted(below, level)) for level in (0.025, 0.975)]
    assert quantiles == [6, 14]
    assert (found.ratio, found.low, found.high) == pytest.approx((1.5, 1.3, 1.7))


def test_many_files_give_the_interval_of_the_mean_of_logarithms():
    logs = np.random.default_rng(1).normal(log(0.8), 0.3, 200)
    found = ratio([[exp(value)] for value in logs], [[[1.0]]] * 200)
    half = 1.96 * logs.std() / sqrt(200)
    assert found.ratio == pytest.approx(exp(logs.mean()))
    assert (log(found.low), log(found.high)) == pytest.approx((logs.mean() - half, logs.mean() + half), abs=0.004)
    assert (found.won, found.files) == ((logs < 0).sum(), 200)


def test_methods_are_compared_at_the_same_poses():
    hard = np.random.default_rng(2).lognormal(0, 2, 12)  # poses differ by far more than the methods
    found = ratio([0.9 * hard], [[hard]])
    assert (found.low, found.ratio, found.high) == pytest.approx((0.9, 0.9, 0.9))


def test_the_best_rival_is_that_of_each_file():
    found = ratio([[1.0, 1.0], [1.0]], [[[2.0, 2.0], [8.0, 8.0]], [[4.0], [0.5]]])
    assert found.ratio == pytest.approx(sqrt(1 / 2 * 2))
    assert (found.won, found.files) == (1, 2)


def test_the_same_seed_gives_the_same_interval():
    draw = np.random.default_rng(5)
    errors, rivals = draw.uniform(1, 2, (4, 6)), draw.uniform(1, 2, (4, 2, 6))
    assert ratio(errors, rivals, seed=4) == ratio(errors, rivals, seed=4)
    assert ratio(errors, rivals, seed=4) != ratio(errors, rivals, seed=5)


def test_a_more_confident_interval_holds_the_other():
    draw = np.random.default_rng(3)
    errors, rivals = draw.uniform(1, 2, (6, 5)), draw.uniform(1, 2, (6, 1, 5))
    for narrow, wide in pairwise([ratio(errors, rivals, confidence=c) for c in (0.5, 0.8, 0.95)]):
        assert wide.low < narrow.low < narrow.high < wide.high


def test_no_error_at_all_is_no_division_by_zero():
    found = ratio([[0.0]], [[[0.0]]])
    assert (found.ratio, found.won) == (1.0, 0)


@pytest.mark.parametrize(
    ("errors", "rivals", "words"),
    [
        ([], [], "at least one file"),
        ([[1.0]], [], "of 1, found 0"),
        ([[1.0, 2.0]], [[[1.0]]], r"file 0: expected errors \(poses,\)"),
        ([[1.0]], [np.empty((0, 1))], "file 0"),
        ([[np.nan]], [[[1.0]]], "finite errors of at least 0"),
        ([[1.0]], [[[-1.0]]], "finite errors of at least 0"),
    ],
)
def test_what_cannot_be_compared_is_refused(errors, rivals, words):
    with pytest.raises(ArgumentError, match=words):
        ratio(errors, rivals)


def test_seeds_that_change_an_order_are_named_for_every_pair():
    values = {"a": [1.0, 1.0, 5.0], "b": [2.0, 3.0, 4.0], "c": [9.0]}
    assert other_orders(values, [7, 8, 9]) == [OtherOrder("a", "b", (9,))]
    assert other_orders({"a": [1.0, 2.0], "b": [1.0, 2.0]}, [0, 1]) == []
