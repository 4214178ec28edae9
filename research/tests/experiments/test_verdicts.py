"""Each rule says "contradicted" of made-up numbers that contradict, and each other verdict of its own."""

import pytest

from neuralmls_research.experiments.reproduce import verdicts
from neuralmls_research.experiments.reproduce.verdicts import Verdict

REPRODUCED, PARTLY, CONTRADICTED = Verdict.REPRODUCED, Verdict.PARTLY, Verdict.CONTRADICTED


@pytest.mark.parametrize(
    ("neural", "classic", "kpd", "verdict"),
    [
        ([1.0, 1.2], 2.0, 3.0, REPRODUCED),
        ([1.0, 2.4], 2.0, 4.0, PARTLY),  # seeds spread by more than the methods
        ([1.0, 1.2], 3.0, 2.0, PARTLY),  # the first is first, the others change places
        ([2.0, 2.2], 1.0, 3.0, CONTRADICTED),
        ([2.0, 2.2], 3.0, 1.0, CONTRADICTED),
    ],
)
def test_an_order_must_hold_by_more_than_seeds_spread(neural, classic, kpd, verdict):
    ruling = verdicts.order({"neural": neural, "classic": [classic], "KPD": [kpd]})
    assert ruling.verdict == verdict
    assert "neural < classic < KPD" in ruling.rule


@pytest.mark.parametrize(
    ("holds", "verdict"), [([True, True], REPRODUCED), ([True, False], PARTLY), ([False, False], CONTRADICTED)]
)
def test_a_category_counts_in_all_in_some_or_in_none(holds, verdict):
    assert verdicts.in_all("it holds", holds).verdict == verdict


def test_a_category_without_a_case_has_no_verdict():
    assert verdicts.in_all("it holds", []).verdict == Verdict.UNTESTABLE
    assert verdicts.in_all("it holds", [True, True], least=3).verdict == Verdict.UNTESTABLE
    assert verdicts.better_in_all([([1.0], 2.0)], "classic", least=2).verdict == Verdict.UNTESTABLE


@pytest.mark.parametrize(("count", "verdict"), [(4, REPRODUCED), (2, REPRODUCED), (1, PARTLY), (0, CONTRADICTED)])
def test_of_unknown_inputs_half_of_the_settings_must_show_it(count, verdict):
    assert verdicts.in_half("it shows", [True] * count + [False] * (4 - count)).verdict == verdict


@pytest.mark.parametrize(
    ("pairs", "verdict"),
    [
        ([([1.0, 1.5], 2.0), ([3.0, 3.5], 4.0)], REPRODUCED),
        ([([1.0, 1.5], 2.0), ([3.0, 4.5], 4.0)], PARTLY),  # one seed fails in the second
        ([([1.0, 2.5], 2.0), ([5.0, 6.0], 4.0)], CONTRADICTED),
    ],
)
def test_every_seed_must_be_better_for_a_case_to_count(pairs, verdict):
    assert verdicts.better_in_all(pairs, "classic").verdict == verdict
    assert verdicts.better_than_each([pairs]).verdict == verdict
    assert verdicts.better_than_each([pairs], least=2).verdict == Verdict.UNTESTABLE  # two comparisons, one deformation


@pytest.mark.parametrize(
    ("values", "verdict"), [([0.1, 0.2], REPRODUCED), ([0.1, 0.6], PARTLY), ([0.6, 0.7], CONTRADICTED)]
)
def test_bounds_hold_with_every_seed(values, verdict):
    assert verdicts.below(0.5, values).verdict == verdict
    assert verdicts.above(-0.5, [-value for value in values]).verdict == verdict
    assert verdicts.less("it", values, 0.5).verdict == verdict
    assert verdicts.more("it", [-value for value in values], -0.5).verdict == verdict


@pytest.mark.parametrize(
    ("values", "verdict"), [([1.0, 1.9], REPRODUCED), ([1.0, 2.5], PARTLY), ([1.0, 4.5], CONTRADICTED)]
)
def test_a_factor_asked_for_is_a_factor(values, verdict):
    assert verdicts.less("it", values, 4.0, factor=2).verdict == verdict


@pytest.mark.parametrize(("end", "verdict"), [(300.0, REPRODUCED), (3.0, PARTLY), (0.5, CONTRADICTED)])
def test_growth_over_a_range_is_by_the_factor(end, verdict):
    assert verdicts.times_more(100, 1.0, end).verdict == verdict


@pytest.mark.parametrize(
    ("values", "verdict"),
    [([1.0, 2.0, 3.0], REPRODUCED), ([1.0, 3.0, 2.0], PARTLY), ([3.0, 4.0, 2.0], CONTRADICTED)],
)
def test_rising_means_with_every_step(values, verdict):
    assert verdicts.rises(values).verdict == verdict
    assert verdicts.falls([-value for value in values]).verdict == verdict


def test_one_value_that_does_it_contradicts_that_none_does():
    assert verdicts.no_value("does it", []).verdict == REPRODUCED
    assert verdicts.no_value("does it", [2.0]).verdict == CONTRADICTED


def test_parts_of_a_claim_that_differ_make_it_partly_reproduced():
    good, bad = verdicts.below(1, [0.0]), verdicts.below(1, [2.0])
    assert verdicts.together(good, good).verdict == REPRODUCED
    assert verdicts.together(good, bad).verdict == PARTLY
    assert verdicts.together(bad, bad).verdict == CONTRADICTED
    assert verdicts.together(good, verdicts.untestable("people")).verdict == Verdict.UNTESTABLE


def test_what_nothing_can_test_has_no_verdict_and_says_what_it_needs():
    ruling = verdicts.untestable("it needs people")
    assert ruling.verdict == Verdict.UNTESTABLE
    assert "it needs people" in ruling.rule
