"""What an experiment hands back: pictures, tables, numbers, and what they say of the paper's claims."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any


class Verdict(StrEnum):
    """What a rule says of the numbers."""

    REPRODUCED = "reproduced"
    PARTLY = "partly reproduced"
    CONTRADICTED = "contradicted"
    UNTESTABLE = "cannot be tested here"


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


@dataclass(frozen=True)
class Claim:
    """Something that the paper says, and what a run gave.

    Attributes
    ----------
    paper : str
        The paper's sentence in our words, with its number where it prints one.
    measure : str
        The paper's measure, on the paper's axis.
    rule : str
        By what the verdict falls, written before any run: a rule of `verdicts`.
    measured : str
        What this run gave, with measures of our own beside; or why nothing could be measured.
    verdict : Verdict
        What the rule says of the numbers.
    reader : str
        What a reader should conclude.
    ours : bool
        Whether this is a check of our own, which the paper says nothing of: it has no part in the paper's verdicts.
    """

    paper: str
    measure: str
    rule: str
    measured: str
    verdict: Verdict
    reader: str
    ours: bool = False


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
