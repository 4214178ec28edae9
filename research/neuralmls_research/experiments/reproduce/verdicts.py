"""The rules by which a claim's verdict falls, each with its sentence: numbers in, sentence and verdict out.

Numbers of trained networks come as one value a seed. "Less" is always better: hand distortions and errors in.

>>> rule, verdict = order({"neural": [1.0, 1.1], "classic": [2.0]})
>>> verdict.value
'reproduced'
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise
from statistics import fmean
from typing import NamedTuple

from neuralmls_research.experiments.reproduce.report import Verdict

Seeds = Sequence[float]  # a value for each seed; one where nothing is drawn by lot


class Ruling(NamedTuple):
    """A rule's sentence, and what it says of the numbers."""

    rule: str
    verdict: Verdict


def order(values: Mapping[str, Seeds]) -> Ruling:
    """Whether methods stand in the paper's order, the first with the least value."""
    groups = list(values.values())
    means = [fmean(group) for group in groups]
    spread = max(_spread(group) for group in groups)
    first = means[0] < min(means[1:])
    apart = all(b - a > spread for a, b in pairwise(means))
    return Ruling(
        f"Reproduced if {' < '.join(values)}, each mean by more than the seeds spread (largest less smallest); partly "
        f"if {next(iter(values))} has the least mean, but not by that much or with the others in another order; "
        "contradicted if another has.",
        Verdict.REPRODUCED if apart else Verdict.PARTLY if first else Verdict.CONTRADICTED,
    )


def in_all(what: str, holds: Sequence[bool]) -> Ruling:
    """Whether something holds in all, in some or in none of the cases of a category."""
    return Ruling(
        f"Reproduced if {what} in all; partly in some; contradicted in none.",
        _share(holds),
    )


def better_in_all(cases: str, pairs: Sequence[tuple[Seeds, float]]) -> Ruling:
    """Whether neural weights, with every seed, have less than a rival in all cases: (neural, rival) of each."""
    return in_all(
        f"neural weights, with every seed, have less than the rival: {cases}",
        [max(neural) < rival for neural, rival in pairs],
    )


def below(bound: float, values: Seeds) -> Ruling:
    """Whether values stay below a bound."""
    return Ruling(
        f"Reproduced if below {bound:g} with every seed; partly with some; contradicted with none.",
        _share([value < bound for value in values]),
    )


def above(bound: float, values: Seeds) -> Ruling:
    """Whether values stay above a bound."""
    return Ruling(
        f"Reproduced if above {bound:g} with every seed; partly with some; contradicted with none.",
        _share([value > bound for value in values]),
    )


def less(what: str, values: Seeds, rival: float, other: str = "the classic one", factor: float = 1) -> Ruling:
    """Whether values are less than a rival, by a factor where one is given."""
    if factor == 1:
        return Ruling(
            f"Reproduced if {what} is less than {other} with every seed; partly with some; contradicted with none.",
            _share([value < rival for value in values]),
        )
    return Ruling(
        f"Reproduced if {what} is less than 1/{factor:g} of {other} with every seed; partly if it is less with every "
        "seed; contradicted otherwise.",
        Verdict.REPRODUCED
        if max(values) * factor < rival
        else Verdict.PARTLY
        if max(values) < rival
        else Verdict.CONTRADICTED,
    )


def more(what: str, values: Seeds, rival: float, other: str = "the classic one") -> Ruling:
    """Whether values are more than a rival."""
    return Ruling(
        f"Reproduced if {what} is more than {other} with every seed; partly with some; contradicted with none.",
        _share([value > rival for value in values]),
    )


def times_more(factor: float, start: float, end: float) -> Ruling:
    """Whether a value grows by a factor from the start of a range to its end."""
    return Ruling(
        f"Reproduced if the value at the end of the range is more than {factor:g} times that at the start; partly if "
        "it is more; contradicted otherwise.",
        Verdict.REPRODUCED if end > factor * start else Verdict.PARTLY if end > start else Verdict.CONTRADICTED,
    )


def rises(values: Sequence[float]) -> Ruling:
    """Whether values rise over a range."""
    steps = [b > a for a, b in pairwise(values)]
    return Ruling(
        "Reproduced if the value rises with every step of the range; partly if it ends above its start; contradicted "
        "otherwise.",
        Verdict.REPRODUCED if all(steps) else Verdict.PARTLY if values[-1] > values[0] else Verdict.CONTRADICTED,
    )


def falls(values: Sequence[float]) -> Ruling:
    """Whether values fall over a range."""
    return Ruling(
        "Reproduced if the value falls with every step of the range; partly if it ends below its start; contradicted "
        "otherwise.",
        rises([-value for value in values]).verdict,
    )


def no_value(what: str, found: Sequence[float]) -> Ruling:
    """Whether no value of a parameter does something; `found` are those that do."""
    return Ruling(
        f"Reproduced if no value {what}; contradicted if one does.",
        Verdict.CONTRADICTED if found else Verdict.REPRODUCED,
    )


def together(*rulings: Ruling) -> Ruling:
    """Several rules for one claim: all must hold; where some do, it is reproduced in part."""
    found = {ruling.verdict for ruling in rulings}
    verdict = found.pop() if len(found) == 1 else Verdict.PARTLY
    parts = " ".join(f"({number}) {ruling.rule}" for number, ruling in enumerate(rulings, 1))
    return Ruling(f"{parts} Where these differ: partly.", verdict)


def untestable(need: str) -> Ruling:
    """A claim that nothing here can test."""
    return Ruling(f"None can be applied: {need}.", Verdict.UNTESTABLE)


def _share(holds: Sequence[bool]) -> Verdict:
    if all(holds):
        return Verdict.REPRODUCED
    return Verdict.PARTLY if any(holds) else Verdict.CONTRADICTED


def _spread(values: Seeds) -> float:
    return max(values) - min(values)
