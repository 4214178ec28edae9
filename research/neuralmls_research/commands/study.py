"""`neuralmls study`: the page that asks people to choose, and the table of what they chose."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from neuralmls.cli.plugin import Stages, console, options, outputs
from neuralmls.errors import ArgumentError, FileError

if TYPE_CHECKING:
    from neuralmls_research.experiments.methods import Method
    from neuralmls_research.experiments.study.answers import Answers
    from neuralmls_research.experiments.study.build import Study
    from neuralmls_research.experiments.study.report import Share

PAGE = "study.html"
FEW = 10  # participants: with fewer, the intervals were seen to be too narrow


@click.group(no_args_is_help=False)
def study() -> None:
    """Ask people which method's result looks most realistic, as the paper did."""


@study.command()
@options.output("The folder to write into.")
@click.option(
    "--methods",
    metavar="NAME,...",
    default="neural,classic,keypoint-deformer",
    help="What is compared: the paper's three, or any that compare knows.",
)
@click.option(
    "--question",
    type=click.Choice(["realistic", "best"]),
    default="realistic",
    help="Which result looks most realistic, as in the paper, or best.",
)
@click.option(
    "--kpd",
    multiple=True,
    metavar="CATEGORY=FILE",
    help="KeypointDeformer's .safetensors for airplane, car or chair (docs/keypoints.md).",
)
@options.quiet
@options.force
def build(*, output: Path, methods: str, question: str, kpd: tuple[str, ...], quiet: bool, force: bool) -> None:
    """Make the study's page.

    It shows 27 deformations by each method, in one HTML file that works offline and by keyboard;
    participants save a file of answers for study report. It is the same page each time. A build
    that was stopped goes on where it was.

    The paper's shapes are used where the folder $NEURALMLS_DATA has them, others otherwise. Where
    --kpd gives weights for a category, KeypointDeformer's keypoints are its control points.
    """
    networks = _networks(kpd)
    data = os.environ.get("NEURALMLS_DATA")
    if data is not None and not Path(data).is_dir():
        raise FileError(f"$NEURALMLS_DATA: there is no folder '{data}'")

    from neuralmls.plugin import write_atomically
    from neuralmls_research.baselines.kpd import KeypointDeformer
    from neuralmls_research.experiments.methods import KPD
    from neuralmls_research.experiments.methods import kpd as kpd_method
    from neuralmls_research.experiments.study.build import STUDY_METHODS
    from neuralmls_research.experiments.study.build import build as make
    from neuralmls_research.experiments.study.cases import COUNT, cases
    from neuralmls_research.experiments.study.store import Store

    names = options.names(methods, [*STUDY_METHODS, KPD])
    chosen = {name: STUDY_METHODS[name] for name in names if name != KPD}
    trained = {category: KeypointDeformer.read(file) for category, file in networks.items()}
    outputs.make_folder(output)
    page = output / PAGE
    outputs.check_output(page, force=force)
    store = Store(output / "unfinished", _made_of(names, chosen, networks))
    stages = Stages(quiet=quiet)
    with stages.stage("study") as report:
        made = make(
            cases(data, trained),
            methods=chosen,
            kpd={category: kpd_method(network) for category, network in trained.items()} if KPD in names else None,
            question=question,
            store=store,
            progress=lambda done: report(done / COUNT),
        )
    write_atomically(page, made.page.encode())
    store.clear()
    if not quiet:
        _show_study(made, chosen, page, stages.seconds["study"])


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


def _made_of(names: list[str], methods: dict[str, Method], networks: dict[str, Path]) -> str:
    """What the pictures hang on: another version, method, setting or network makes others."""
    from hashlib import sha256

    from neuralmls import __version__

    settings = {name: (method.title, method.settings) for name, method in methods.items()}
    files = {category: sha256(file.read_bytes()).hexdigest() for category, file in networks.items()}
    return repr((__version__, names, settings, files))


def _show_study(made: Study, methods: dict[str, Method], page: Path, seconds: float) -> None:
    """Say what the study shows, and what it does not, and why."""
    size = page.stat().st_size / 1e6
    before = f", {made.kept} of them before" if made.kept else ""
    count = f"{len(made.questions)} questions{before}"
    console.line(f"{page}: {count}, {size:.1f} MB, made in {seconds:.0f} s", sys.stdout)
    shapes = {(question.category, question.shape): question for question in made.questions}
    rows = [(name, category, _listed(shown.methods), shown.origin) for (category, name), shown in shapes.items()]
    console.table(["shape", "category", "methods", "origin"], rows, file=sys.stdout)
    console.line("", sys.stdout)
    console.pairs([(name, method.title) for name, method in methods.items()])
    reasons: dict[str, list[str]] = {}
    for question in made.questions:
        for reason in question.left_out.values():
            names = reasons.setdefault(reason, [])
            if question.shape not in names:
                names.append(question.shape)
    if reasons:
        print("\nLeft out:")
    for reason, names in reasons.items():
        console.line(f"  {', '.join(names)}: {reason}", sys.stdout)
    print("\nGive the page to each participant; count their files with: neuralmls study report FILES...")


def _listed(names: tuple[str, ...]) -> str:
    """Method names in an order of their own: that of the page's file is drawn by lot."""
    return ", ".join(sorted(names))


@study.command()
@click.argument("files", nargs=-1, required=True, type=options.PATH)
@click.option("--csv", type=options.PATH, help="Write the table, .csv.")
@click.option("--latex", type=options.PATH, help="Write the table for a paper, .tex.")
@options.json
@options.force
def report(*, files: tuple[Path, ...], csv: Path | None, latex: Path | None, json: bool, force: bool) -> None:
    """Count a study's answers.

    The paper's Table 2: how often each method was chosen where it was shown, for each category and overall. Intervals
    are Wilson's at 95 %, widened by how much participants differ: one person's answers resemble
    each other.
    """
    from neuralmls.plugin import write_atomically
    from neuralmls_research.experiments.study.answers import read_answers
    from neuralmls_research.experiments.study.report import shares
    from neuralmls_research.experiments.study.tables import csv_of, latex_of

    for file, ending in ((csv, "csv"), (latex, "tex")):
        if file is not None:
            outputs.check_ending(file, [ending], "a table")
            outputs.check_output(file, force=force, inputs=files)
    answers = read_answers(files)
    rows = shares(answers)
    if csv is not None:
        write_atomically(csv, csv_of(rows).encode())
    if latex is not None:
        write_atomically(latex, latex_of(rows, len(answers.participants)).encode())
    if json:
        console.document(_document(answers, rows))
    else:
        _show_shares(answers, rows)


def _document(answers: Answers, rows: list[Share]) -> dict[str, Any]:
    from dataclasses import asdict

    from neuralmls_research.experiments.study.report import CONFIDENCE

    return {
        "study": answers.study,
        "asked": answers.questions[0].asked,
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
    from neuralmls_research.experiments.study.wording import WORDINGS

    people, questions = len(answers.participants), len(answers.questions)
    given = sum(len(person.chosen) for person in answers.participants)
    console.line(WORDINGS[answers.questions[0].asked].title, sys.stdout)
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
