"""A line of the table, and what a wrong answer is."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal


class WrongAnswer(Exception):
    """A contender's answer is not right, so that its time says nothing."""


def check(what: str, error: float, tolerance: float) -> str:
    """Hold an error against its tolerance, and say so in words.

    Raises
    ------
    WrongAnswer
        The error is larger, or not a number.
    """
    if not error <= tolerance:
        raise WrongAnswer(f"{what}: the error is {error:.2g}, at most {tolerance:.0e} is right")
    return f"{what}: {error:.1e} (at most {tolerance:.0e})"


@dataclass(frozen=True)
class Row:
    """One figure of ours, in seconds, bytes or as a plain number, beside a rival's.

    `bar` is held against `ratio`: "faster" is how many times faster we are (at least), "times" how many times the
    rival's time we take (at most). Without a rival it is held against our figure itself (at most).
    """

    what: str
    ours: float
    rival: str = ""
    theirs: float | None = None
    sense: Literal["faster", "times"] = "faster"
    bar: float | None = None
    limit: float | None = None
    unit: Literal["s", "B", ""] = "s"

    @property
    def ratio(self) -> float | None:
        """How many times faster, or how many times the time."""
        if self.theirs is None:
            return None
        return self.theirs / self.ours if self.sense == "faster" else self.ours / self.theirs

    @property
    def met(self) -> bool | None:
        """Whether the bar is met; None if there is none."""
        if self.bar is None:
            return None
        if self.ratio is None:
            return self.ours <= self.bar
        return self.ratio >= self.bar if self.sense == "faster" else self.ratio <= self.bar


@dataclass(frozen=True)
class Outcome:
    """What a definition found: its rows, the answers that were checked in words, and figures that have no bar."""

    title: str
    rows: list[Row]
    answers: list[str]
    series: list[dict[str, float | int | str]]
