"""`neuralmls study`: the page that asks people which result looks best, and the table of what they chose."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from neuralmls.cli.plugin import Stages, console, options, outputs
from neuralmls.errors import ArgumentError, FileError

if TYPE_CHECKING:
    from neuralmls_research.experiments.study.answers import Answers
    from neuralmls_research.experiments.study.build import Study
    from neuralmls_research.experiments.study.report import Share

PAGE = "study.html"
FEW = 10  # participants: with fewer, the intervals were seen to be too narrow


@click.group(no_args_is_help=False)
def study() -> None:
    """Ask people which method's result looks best, as the paper did."""


@study.command()
@options.output("The folder to write into.")
@click.option(
    "--kpd", multiple=True, metavar="CATEGORY=FILE", help="KeypointDeformer's .safetensors for airplane, car or chair."
)
@options.quiet
@options.force
def build(*, output: Path, kpd: tuple[str, ...], quiet: bool, force: bool) -> None:
    """Make the study's page.

    It shows 27 deformations by each method, in one HTML file that works offline and by keyboard;
    participants save a file of answers for study report.
    The paper's shapes are used where the folder $NEURALMLS_DATA has them, others otherwise.
    """
    networks = _networks(kpd)
    data = os.environ.get("NEURALMLS_DATA")
    if data is not None and not Path(data).is_dir():
        raise FileError(f"$NEURALMLS_DATA: there is no folder '{data}'")

    from neuralmls.plugin import write_atomically
    from neuralmls_research.experiments import methods
    from neuralmls_research.experiments.study.build import build as make
    from neuralmls_research.experiments.study.cases import COUNT, cases

    trained = {category: methods.kpd(file) for category, file in networks.items()}
    outputs.make_folder(output)
    page = output / PAGE
    outputs.check_output(page, force=force)
    stages = Stages(quiet=quiet)
    with stages.stage("study") as report:
        made = make(cases(data), kpd=trained, progress=lambda done: report(done / COUNT))
    write_atomically(page, made.page.encode())
    if not quiet:
        _show_study(made, page, stages.seconds["study"])


def _networks(given: tuple[str, ...]) -> dict[str, Path]:
    """KeypointDeformer's files by category."""
    from neuralmls_research.experiments.study.cases import CATEGORIES

    networks = {}
    for text in given:
        category, equals, file = text.partition("=")
        if category not in CATEGORIES or not equals or not file:
            raise ArgumentError(f"--kpd: expected CATEGORY=FILE with one of {', '.join(CATEGORIES)}, found '{text}'")
        networks[category] = Path(file)
    return networks


def _show_study(made: Study, page: Path, seconds: float) -> None:
    """Say what the study shows, and what it does not, and why."""
    size = page.stat().st_size / 1e6
    console.line(f"{page}: {len(made.questions)} questions, {size:.1f} MB, made in {seconds:.0f} s", sys.stdout)
    shapes = {(question.category, question.shape): question for question in made.questions}
    rows = [(name, category, _listed(shown.methods), shown.origin) for (category, name), shown in shapes.items()]
    console.table(["shape", "category", "methods", "origin"], rows, file=sys.stdout)
    print("\nLeft out:")
    reasons: dict[str, list[str]] = {}
    for question in made.questions:
        for reason in question.left_out.values():
            names = reasons.setdefault(reason, [])
            if question.shape not in names:
                names.append(question.shape)
    for reason, names in reasons.items():
        console.line(f"  {', '.join(names)}: {reason}", sys.stdout)
    print("\nGive the page to each participant; count their files with: neuralmls study report FILES...")


def _listed(names: tuple[str, ...]) -> str:
    """Method names in an order of their own: that of the page's file is drawn by lot."""
    return ", ".join(sorted(names))


@study.command()
@click.argument("files", nargs=-1, required=True, type=options.PATH)
@options.json
def report(*, files: tuple[Path, ...], json: bool) -> None:
    """Count a study's answers.

    The paper's Table 2: how often each method was chosen where it was shown, for each category and overall. Intervals
    are Wilson's at 95 %, widened by how much participants differ: one person's answers resemble
    each other.
    """
    from neuralmls_research.experiments.study.answers import read_answers
    from neuralmls_research.experiments.study.report import shares

    answers = read_answers(files)
    rows = shares(answers)
    if json:
        console.document(_document(answers, rows))
    else:
        _show_shares(answers, rows)


def _document(answers: Answers, rows: list[Share]) -> dict[str, Any]:
    from dataclasses import asdict

    from neuralmls_research.experiments.study.report import CONFIDENCE

    return {
        "study": answers.study,
        "participants": len(answers.participants),
        "answers": sum(len(person.chosen) for person in answers.participants),
        "questions": len(answers.questions),
        "confidence": CONFIDENCE,
        "interval": "Wilson, with the effective number of answers of clustered participants",
        "shares": [asdict(row) for row in rows],
        "left_out": [
            {"category": question.category, "shape": question.shape, "displacement": question.displacement}
            | {"method": method, "reason": reason}
            for question in answers.questions
            for method, reason in question.left_out.items()
        ],
    }


def _show_shares(answers: Answers, rows: list[Share]) -> None:
    people, questions = len(answers.participants), len(answers.questions)
    given = sum(len(person.chosen) for person in answers.participants)
    print(f"{_count(people, 'participant')}, {given:,} of {people * questions:,} questions answered")
    cells, category = [], ""
    for row in rows:
        cells.append((
            row.category if row.category != category else "", row.method, f"{100 * row.share:.1f} %",
            f"{100 * row.low:.1f} to {100 * row.high:.1f} %", f"{row.chosen:,} of {row.shown:,}",
            f"{100 * row.chance:.1f} %",
        ))  # fmt: skip
        category = row.category
    head = ["category", "method", "chosen", "95 % interval", "answers", "by chance"]
    console.table(head, cells, range(2, len(head)))
    partial = sum(len(person.chosen) < questions for person in answers.participants)
    if partial:
        console.warning(f"{_count(partial, 'participant')} did not answer all {questions} questions")
    if people < FEW:
        console.warning(f"fewer than {FEW} participants: the intervals are rough")


def _count(number: int, noun: str) -> str:
    return f"{number:,} {noun}" if number == 1 else f"{number:,} {noun}s"
