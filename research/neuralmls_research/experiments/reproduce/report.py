"""What an experiment hands back: pictures, tables, numbers, and what they say of the paper's claims."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

REPRODUCED, NOT_REPRODUCED, UNTESTABLE = "reproduced", "not reproduced", "cannot be tested here"


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
        The claim, with the paper's number where it prints one.
    measured : str
        What was measured; or why nothing could be.
    holds : bool or None
        Whether the measurement agrees; None where there is none.
    """

    paper: str
    measured: str
    holds: bool | None

    @property
    def verdict(self) -> str:
        """In words."""
        if self.holds is None:
            return UNTESTABLE
        return REPRODUCED if self.holds else NOT_REPRODUCED


@dataclass(frozen=True)
class Table:
    """Rows of text below a head; the first column names the row."""

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
