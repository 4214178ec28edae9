"""What the study asks: the paper's question, and the one about what people would want."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Wording:
    """The page's words for one question.

    Attributes
    ----------
    title : str
        The question itself.
    short : str
        The same after "Question 3 of 27: ".
    choose, meaning : str
        What to choose, and what that is to mean.
    """

    title: str
    short: str
    choose: str
    meaning: str


WORDINGS = {
    "realistic": Wording(
        "Which result looks most realistic?",
        "which result looks most realistic?",
        "Choose the one that looks most realistic to you:",
        "the one that you would most readily take for a real object of this kind. There are no right answers.",
    ),
    "best": Wording(
        "Which result looks best?",
        "which result looks best?",
        "Choose the one that looks best to you:",
        "the one that you would expect, or would want, when you move the points like that. There are no right answers.",
    ),
}
