"""What an experiment hands back: pictures, tables, numbers, and what they say of the paper's claims."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, NamedTuple

from neuralmls_research.experiments.reproduce.verdicts import Ruling, Verdict


@dataclass(frozen=True)
class Picture:
    """A picture of the output folder.

    Attributes
    ----------
    file : str
        Its name in the folder.
    caption : str
        What to see on it.
    """

    file: str
    caption: str


class Conclusions(NamedTuple):
    """What a reader should conclude from each verdict, whichever it turns out to be."""

    reproduced: str
    partly: str
    contradicted: str


@dataclass(frozen=True)
class Claim:
    """Something that the paper says, and what a run gave.

    Attributes
    ----------
    paper : str
        The paper's sentence in our words, with its number where it prints one.
    measure : str
        The paper's measure, on the paper's axis.
    ruling : Ruling
        By what the verdict falls, written before any run, and what it says of the numbers: from `verdicts`.
    measured : str
        What this run gave, with measures of our own beside; or why nothing could be measured.
    conclusions : Conclusions
        What a reader should conclude; None of what can never be tested here.
    ours : bool
        Whether this is a check of our own, which the paper says nothing of: it has no part in the paper's verdicts.
    """

    paper: str
    measure: str
    ruling: Ruling
    measured: str
    conclusions: Conclusions | None = None
    ours: bool = False

    @property
    def verdict(self) -> Verdict:
        """What the rule says of the numbers."""
        return self.ruling.verdict

    @property
    def reader(self) -> str:
        """What a reader should conclude from this verdict."""
        if self.conclusions is None or self.verdict is Verdict.UNTESTABLE:
            return "Nothing can be concluded from this run."
        told = {Verdict.REPRODUCED: self.conclusions.reproduced, Verdict.PARTLY: self.conclusions.partly}
        return told.get(self.verdict, self.conclusions.contradicted)

    def for_machines(self) -> dict[str, Any]:
        """All of it by name, as JSON holds it."""
        return {
            "paper": self.paper,
            "measure": self.measure,
            "rule": self.ruling.rule,
            "measured": self.measured,
            "verdict": self.verdict,
            "reader": self.reader,
            "ours": self.ours,
        }


@dataclass(frozen=True)
class Table:
    """Rows of text below a head; the first column names the row.

    Attributes
    ----------
    name : str
        Short, stable, the only one of its kind in all reports, and fit for a file.
    """

    name: str
    caption: str
    head: list[str]
    rows: list[list[str]]


@dataclass
class Report:
    """All that one experiment gave.

    Attributes
    ----------
    setting : str
        With which shapes and parameters it ran.
    numbers : dict
        What was measured, for machines: anything that JSON can hold.
    missing : list of str
        What could not be run, and what it would need.
    """

    setting: str
    pictures: list[Picture] = field(default_factory=list)
    tables: list[Table] = field(default_factory=list)
    claims: list[Claim] = field(default_factory=list)
    numbers: dict[str, Any] = field(default_factory=dict)
    missing: list[str] = field(default_factory=list)
