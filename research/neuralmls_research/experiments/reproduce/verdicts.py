"""The rules by which a claim's verdict falls, each with its sentence: numbers in, sentence and verdict out.

Numbers of trained networks come as one value a seed. "Less" is always better: hand distortions and errors in.

>>> rule, verdict = order({"neural": [1.0, 1.1], "classic": [2.0]})
>>> verdict.value
'reproduced'
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from enum import StrEnum
from itertools import pairwise
from statistics import fmean
from typing import NamedTuple, TypeAlias

Seeds: TypeAlias = Sequence[float]  # a value for each seed; one where nothing is drawn by lot
Pair: TypeAlias = tuple[Seeds, float]  # neural weights, and another method


class Verdict(StrEnum):
    """What a rule says of the numbers."""

    REPRODUCED = "reproduced"
    PARTLY = "partly reproduced"
    CONTRADICTED = "contradicted"
    UNTESTABLE = "cannot be tested here"


class Ruling(NamedTuple):
    """A rule's sentence, and what it says of the numbers."""

    rule: str
    verdict: Verdict


def order(values: Mapping[str, Seeds]) -> Ruling:
    """Whether methods stand in the paper's order, the first with the least value."""
    groups = list(values.values())
    means = [fmean(group) for group in groups]
    spread = max(_spread(group) for group in groups)
    apart = all(b - a > spread for a, b in pairwise(means))
    beaten = means[0] - min(means[1:]) > spread
    return Ruling(
        f"Reproduced if {' < '.join(values)}, each mean by more than the seeds spread (largest less smallest); "
        f"contradicted if another has a lower mean than {next(iter(values))} by more than that; partly otherwise.",
        Verdict.REPRODUCED if apart else Verdict.CONTRADICTED if beaten else Verdict.PARTLY,
    )


def in_all(what: str, holds: Sequence[bool], least: int = 1) -> Ruling:
    """Whether something holds in all, in some or in none of the cases of a category; `least` must be there."""
    return _counted(f"Reproduced if {what} in all cases; partly in some; contradicted in none.", holds, least)


def better_in_all(pairs: Sequence[Pair], rival: str, least: int = 1) -> Ruling:
    """Whether neural weights have less than one other method in all deformations, a pair each."""
    return _counted(
        f"A deformation counts if neural weights have less than {rival}, with every seed. Reproduced if all count; "
        "partly if some do; contradicted if none does.",
        [max(neural) < other for neural, other in pairs],
        least,
    )


def better_than_each(deformations: Sequence[Sequence[Pair]], least: int = 1) -> Ruling:
    """Whether neural weights have less than every other method that applies: of each deformation, a pair for each."""
    rule = (
        "Each deformation is compared with each other method of the paper that applies to it; a comparison counts if "
        "neural weights have less, with every seed. Reproduced if all count; partly if some do; contradicted if none "
        "does."
    )
    if len(deformations) < least:
        return _counted(rule, [False] * len(deformations), least)
    return _counted(rule, [max(neural) < other for pairs in deformations for neural, other in pairs])


def in_half(what: str, holds: Sequence[bool]) -> Ruling:
    """Whether something is seen in half of the settings of a grid, in some, or in none: for inputs that are unknown."""
    ruling = _counted(
        f"Reproduced if {what} in half of the settings or more; partly in some; contradicted in none.", holds
    )
    if ruling.verdict == Verdict.PARTLY and 2 * sum(holds) >= len(holds):
        return Ruling(ruling.rule, Verdict.REPRODUCED)
    return ruling


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
    """Several rules for one claim: it is partly reproduced where they differ, untestable where one of them is."""
    found = {ruling.verdict for ruling in rulings}
    verdict = Verdict.PARTLY
    if len(found) == 1 or Verdict.UNTESTABLE in found:
        verdict = Verdict.UNTESTABLE if Verdict.UNTESTABLE in found else found.pop()
    parts = " ".join(f"({number}) {ruling.rule}" for number, ruling in enumerate(rulings, 1))
    return Ruling(f"{parts} Where these differ: partly.", verdict)


def untestable(need: str) -> Ruling:
    """A claim that nothing here can test, and what that would need."""
    return Ruling(f"None can be applied: {need}.", Verdict.UNTESTABLE)


def _counted(rule: str, holds: Sequence[bool], least: int = 1) -> Ruling:
    """All, some or none of cases; nothing to say where there are fewer than `least`."""
    if len(holds) < least:
        return untestable(f"it takes {least} or more cases, and {len(holds)} are here")
    return Ruling(f"{rule} It takes {least} cases or more." if least > 1 else rule, _share(holds))


def _share(holds: Sequence[bool]) -> Verdict:
    if all(holds):
        return Verdict.REPRODUCED
    return Verdict.PARTLY if any(holds) else Verdict.CONTRADICTED


def _spread(values: Seeds) -> float:
    return max(values) - min(values)
