"""The paper's Table 2: how often each method was chosen, for each category and overall, with confidence intervals.

Answers of one participant resemble each other, and an interval that takes them for independent is too narrow. These
are Wilson intervals of the effective number of answers, estimated from how far participants differ (Kish 1965; Dean,
Pagano 2015). Unlike a bootstrap over participants they keep a width where everyone chose alike.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt
from statistics import NormalDist

import numpy as np
from numpy.typing import ArrayLike

from neuralmls.errors import ArgumentError
from neuralmls_research.experiments.study.answers import Answers, Participant
from neuralmls_research.experiments.study.key import Question

OVERALL = "overall"
CONFIDENCE = 0.95


@dataclass(frozen=True)
class Share:
    """How often a method was chosen where it was shown.

    Attributes
    ----------
    category, method : str
    chosen, shown : int
        Answers that chose the method, and answers to questions that showed it.
    share, low, high : float
        chosen / shown, and its confidence interval.
    chance : float
        The share that choosing blindly would give.
    """

    category: str
    method: str
    chosen: int
    shown: int
    share: float
    low: float
    high: float
    chance: float


def shares(answers: Answers) -> list[Share]:
    """Count the choices: a row for each method that was shown in a category, the categories in order, overall last.

    A method counts where it was shown: one that does not apply to some shapes is judged by the others. Methods are in
    the order of their overall shares.
    """
    questions = answers.questions
    categories = list(dict.fromkeys(question.category for question in questions))
    methods = list(dict.fromkeys(method for question in questions for method in question.methods))
    overall = [row for method in methods if (row := _share(OVERALL, method, questions, answers.participants))]
    overall.sort(key=lambda row: (-row.share, row.method))
    rows = []
    for category in categories:
        asked = [question for question in questions if question.category == category]
        of_methods = (_share(category, row.method, asked, answers.participants) for row in overall)
        rows += [row for row in of_methods if row]
    return rows + overall


def _share(category: str, method: str, questions: list[Question], participants: list[Participant]) -> Share | None:
    """A method's share in some questions; None where it was not shown."""
    asked = [question for question in questions if method in question.methods]
    counts, blind = [], 0.0
    for participant in participants:
        seen = [question for question in asked if question.id in participant.chosen]
        counts.append((sum(participant.chosen[question.id] == method for question in seen), len(seen)))
        blind += sum(1 / len(question.methods) for question in seen)
    chosen, shown = map(sum, zip(*counts, strict=True))
    if not shown:
        return None
    low, high = interval(counts)
    return Share(category, method, chosen, shown, chosen / shown, low, high, blind / shown)


def interval(counts: ArrayLike, confidence: float = CONFIDENCE) -> tuple[float, float]:
    """Return the confidence interval of a share, Wilson's with the effective number of answers.

    With `c_i` of `n_i` answers of participant i, the share `s = sum c / sum n` and `g` participants:

        n_effective = s (1 - s) / v,   v = g / (g - 1) sum (c_i - s n_i)^2 / (sum n)^2

    within g, as many as participants, and all n answers; g where nothing tells (one participant; all chose alike).

    Parameters
    ----------
    counts : (g, 2) integers
        For each participant, how many of their answers chose the method, and how many answers they gave.
    confidence : float, 0 to 1

    Raises
    ------
    ArgumentError
        There is no answer, or a participant chose more often than they answered.

    Source
    ------
    Wilson 1927; Kish, Survey Sampling, 1965; Dean, Pagano, Evaluating confidence interval methods for binomial
    proportions in clustered surveys, 2015.

    Examples
    --------
    >>> [round(bound, 3) for bound in interval([(6, 9), (3, 9), (7, 9)])]    # 16 of 27, by three participants
    [0.34, 0.804]
    """
    table = np.asarray(counts, dtype=np.float64)
    if table.ndim != 2 or table.shape[1] != 2 or (table < 0).any() or (table[:, 0] > table[:, 1]).any():
        raise ArgumentError("counts: expected rows of choices and answers, no more choices than answers")
    chosen, given = table[table[:, 1] > 0].T
    people, answers = len(given), float(given.sum())
    if not people:
        raise ArgumentError("counts: expected at least one answer, found none")
    share = float(chosen.sum()) / answers
    effective = float(people)
    if people > 1 and 0 < share < 1:
        variance = people / (people - 1) * float(((chosen - share * given) ** 2).sum()) / answers**2
        effective = answers if variance == 0 else min(max(share * (1 - share) / variance, people), answers)
    z = NormalDist().inv_cdf((1 + confidence) / 2)
    middle = share + z * z / (2 * effective)
    half = z * sqrt(share * (1 - share) / effective + (z / (2 * effective)) ** 2)
    scale = 1 + z * z / effective
    return max((middle - half) / scale, 0.0), min((middle + half) / scale, 1.0)
