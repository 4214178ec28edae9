"""`neuralmls benchmark`: what methods reach where the truth is known."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from neuralmls.cli.plugin import Stages, console, options
from neuralmls.errors import ArgumentError, FileError, NotApplicable

if TYPE_CHECKING:
    from neuralmls_research.experiments.poses import Poses


@click.group(no_args_is_help=False)
def benchmark() -> None:
    """Measure the methods where the truth is known."""


@benchmark.command()
@click.argument("folder", type=options.PATH)
@click.option(
    "--methods",
    metavar="NAME,...",
    help="rbf,classic,neural,shape-aware-exact,arap if not given; also neural-exact,shape-aware,biharmonic.",
)
@click.option("--counts", metavar="M,...", default="12,40", help="Numbers of control points.")
@options.json
@options.quiet
def poses(*, folder: Path, methods: str | None, counts: str, json: bool, quiet: bool) -> None:
    """Compare deformed shapes with their true poses.

    FOLDER holds .npz files with the arrays rest (n, 3), poses (k, n, 3) and faces (f, 3).

    Control points, spread over the shape at rest, move to where they are in a pose; how far are
    the other vertices from where they are? The mean over vertices and up to six poses of a
    file, in % of the diagonal of the box at rest.
    """
    from neuralmls_research.experiments.poses import POSE_METHODS, QUICK

    chosen = list(QUICK) if methods is None else options.names(methods, POSE_METHODS)
    numbers = _numbers(counts)
    if not folder.is_dir():
        raise FileError(f"{folder}: expected a folder of .npz files")
    files = sorted(folder.glob("*.npz"))
    if not files:
        raise FileError(f"{folder}: there is no .npz file in this folder")
    told: list[dict[str, Any]] = []
    refused = 0
    stages = Stages(quiet=quiet)
    for file in files:
        try:
            told += _measured(file, chosen, numbers, stages)
        except FileError as error:
            console.error(str(error))
            refused += 1
    if json:
        console.document({"unit": "% of the diagonal of the box at rest", "rows": told})
    elif told:
        _show(told, chosen)
    if refused:
        raise click.exceptions.Exit(1)


def _measured(file: Path, names: list[str], counts: list[int], stages: Stages) -> list[dict[str, Any]]:
    """A row for each number of control points."""
    from neuralmls_research.experiments.poses import read_poses

    with stages.stage("read"):
        content = read_poses(file)
    rows = []
    for count in counts:
        errors: dict[str, float | None] = {}
        reasons: dict[str, str] = {}
        for name in names:
            with stages.stage(f"{content.name}, {count}, {name}"):
                errors[name], reason = _error(content, name, count, file)
            if reason is not None:
                reasons[name] = reason
        rows.append({"file": str(file), "control_points": count, "errors": errors, "not_applicable": reasons})
    return rows


def _error(content: Poses, name: str, count: int, file: Path) -> tuple[float | None, str | None]:
    """The mean error, or why there is none."""
    from neuralmls_research.experiments.poses import POSE_METHODS, pose_errors

    try:
        errors = pose_errors(content, POSE_METHODS[name], count)
    except NotApplicable as error:
        return None, str(error)
    except ArgumentError as error:
        raise FileError(f"{file}: {error}") from None
    return sum(errors) / len(errors), None


def _show(rows: list[dict[str, Any]], names: list[str]) -> None:
    from neuralmls_research.experiments.poses import POSE_METHODS

    print("mean error in % of the diagonal")
    cells = []
    for row in rows:
        values = (row["errors"][name] for name in names)
        cells.append(
            (Path(row["file"]).stem, str(row["control_points"]), *("-" if v is None else f"{v:.2f}" for v in values))
        )
    head = ["file", "control points", *(POSE_METHODS[name].title for name in names)]
    console.table(head, cells, range(1, len(head)))
    for row in rows:
        for name, reason in row["not_applicable"].items():
            where = f"{Path(row['file']).stem}, {row['control_points']} control points"
            console.line(f"  {POSE_METHODS[name].title} does not apply to {where}: {reason}", sys.stdout)


def _numbers(text: str) -> list[int]:
    try:
        numbers = [int(number) for number in text.split(",")]
    except ValueError:
        numbers = []
    if not numbers or min(numbers) < 1:
        raise ArgumentError(f"--counts: expected whole numbers above 0 with commas between, found '{text}'")
    return numbers
