"""What participants saved: read, and refused where it cannot be counted."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from neuralmls.errors import FileError
from neuralmls_research.experiments.study.key import Question, opened

FORMAT = "neuralmls-study-answers-1"
LARGEST = 10_000_000  # bytes; a file of answers has some tens of thousands


@dataclass(frozen=True)
class Participant:
    """One participant's choices: the method chosen, by the question's id."""

    id: str
    chosen: dict[str, str]


@dataclass(frozen=True)
class Answers:
    """What all participants of one study chose."""

    study: str
    questions: list[Question]
    participants: list[Participant]


def read_answers(paths: Sequence[str | os.PathLike[str]]) -> Answers:
    """Read the files of the participants of one study, at least one.

    Raises
    ------
    FileError
        A file is missing, is no file of answers or a changed one; it answers nothing, or another study than the first
        one does; its participant is there already.
    """
    if not paths:
        raise FileError("expected at least one file of answers, found none")
    study, first = "", Path()
    questions: list[Question] = []
    participants: dict[str, tuple[Participant, Path]] = {}
    for path in map(Path, paths):
        document = _document(path)
        try:
            if not study:
                questions = opened(document["study"], document["key"])
                study, first = document["study"], path
            elif document["study"] != study:
                raise FileError(f"expected answers to the same study as {first}, found those to another one")
            participant = Participant(document["participant"], _chosen(document["answers"], questions))
            if participant.id in participants:
                other = participants[participant.id][1]
                raise FileError(f"these are the answers of the same participant as in {other}")
        except FileError as error:
            raise FileError(f"{path}: {error}") from error
        participants[participant.id] = participant, path
    return Answers(study, questions, [participant for participant, _ in participants.values()])


def _document(path: Path) -> dict[str, Any]:
    """The content of a file of answers, its fields of the right kinds."""
    try:
        if path.stat().st_size > LARGEST:
            raise FileError(f"{path}: expected a study's answers, found a file too large for them")
        document = json.loads(path.read_bytes())
    except OSError as error:
        raise FileError(f"{path}: cannot read: {error.strerror or error}") from error
    except (ValueError, RecursionError) as error:
        if isinstance(error, FileError):
            raise
        raise FileError(f"{path}: expected answers as the study's page saves them, found no JSON file") from error
    if not isinstance(document, dict) or document.get("format") != FORMAT:
        found = document.get("format") if isinstance(document, dict) else None
        raise FileError(f"{path}: expected answers of the format '{FORMAT}', found {found!r}")
    for field, kind in (("study", str), ("key", str), ("participant", str), ("answers", list)):
        if not isinstance(document.get(field), kind):
            raise FileError(f"{path}: expected '{field}' to be a {_kind(kind)}, found {document.get(field)!r:.40}")
    return document


def _kind(kind: type) -> str:
    return "text" if kind is str else "list"


def _chosen(answers: Iterable[Any], questions: Sequence[Question]) -> dict[str, str]:
    """The method chosen at each question that is answered."""
    by_id = {question.id: question for question in questions}
    chosen: dict[str, str] = {}
    for number, answer in enumerate(answers, 1):
        question = by_id.get(str(answer.get("question"))) if isinstance(answer, dict) else None
        if question is None:
            raise FileError(f"answer {number} is to no question of this study")
        if question.id in chosen:
            raise FileError(f"answer {number} is a second one to question '{question.id}'")
        choice, count = answer.get("choice"), len(question.methods)
        if not isinstance(choice, int) or isinstance(choice, bool) or not 0 <= choice < count:
            raise FileError(f"answer {number}: expected a choice from 0 to {count - 1}, found {choice!r}")
        chosen[question.id] = question.methods[choice]
    if not chosen:
        raise FileError("no question is answered")
    return chosen
