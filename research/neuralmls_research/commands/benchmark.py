"""`neuralmls benchmark`: what methods reach where the truth is known."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from neuralmls.cli.plugin import Stages, console, options
from neuralmls.errors import ArgumentError, FileError, NeuralMLSError
from neuralmls_research.commands import pose_tables, settings

if TYPE_CHECKING:
    from neuralmls_research.experiments.against_rivals import Measured
    from neuralmls_research.experiments.methods import Method
    from neuralmls_research.experiments.poses import Poses


@click.group(no_args_is_help=False)
def benchmark() -> None:
    """Measure the methods where the truth is known."""


@benchmark.command()
@click.argument("folder", type=options.PATH)
@click.option(
    "--methods",
    metavar="NAME,...",
    help="neural,neural-exact,shape-aware,shape-aware-exact,neural-relax,shape-aware-relax,classic,rbf,arap,"
    "arap-from-fit,biharmonic-displacements if not given; also biharmonic, which is slow.",
)
@settings.options(alpha=2)
@click.option("--counts", metavar="M,...", default="12,40", help="Numbers of control points.")
@options.json
@options.quiet
def poses(
    *, folder: Path, methods: str | None, said: dict[str, Any], seeds: int, counts: str, json: bool, quiet: bool
) -> None:
    """Compare deformed shapes with their true poses.

    FOLDER holds .npz files with the arrays rest (n, 3), poses (k, n, 3) and faces (f, 3).

    Control points, spread over the shape at rest, move to where they are in a pose; how far are
    the other vertices from where they are? The mean over vertices and up to six poses of a
    file, in % of the diagonal of the box at rest.

    Then each method with learned weights against the best other one of each file: the geometric
    mean of the ratios of their errors, its interval by a paired bootstrap over files and poses,
    and on how many files it is better.
    """
    from neuralmls_research.experiments.compare import load_libraries
    from neuralmls_research.experiments.methods import with_settings
    from neuralmls_research.experiments.poses import POSE_METHODS, QUICK

    names = list(QUICK) if methods is None else options.names(methods, POSE_METHODS)
    chosen = settings.by_seed(with_settings({name: POSE_METHODS[name] for name in names}, said), seeds)
    numbers = _numbers(counts)
    if not folder.is_dir():
        raise FileError(f"{folder}: expected a folder of .npz files")
    files = sorted(folder.glob("*.npz"))
    if not files:
        raise FileError(f"{folder}: there is no .npz file in this folder")
    load_libraries()
    measured: list[Measured] = []
    refused = 0
    stages = Stages(quiet=quiet)
    for file in files:
        try:
            measured += _measured(file, chosen, numbers, stages)
        except FileError as error:
            console.error(str(error))
            refused += 1
    if json:
        console.document(pose_tables.document(measured, chosen))
    elif measured:
        pose_tables.show(measured, chosen, sys.stdout)
    if refused:
        raise click.exceptions.Exit(1)


def _measured(file: Path, methods: dict[str, list[Method]], counts: list[int], stages: Stages) -> list[Measured]:
    """What is measured of a file for each number of control points."""
    from neuralmls_research.experiments.against_rivals import Measured
    from neuralmls_research.experiments.poses import read_poses

    with stages.stage("read"):
        content = read_poses(file)
    found = []
    for count in counts:
        row = Measured(str(file), count, {}, {})
        for name, several in methods.items():
            with stages.stage(f"{content.name}, {count}, {name}"):
                try:
                    row.errors[name] = [_errors(content, method, count, file) for method in several]
                except FileError:
                    raise
                except NeuralMLSError as error:  # named, never passed over: it does not apply, or is not installed
                    row.not_applicable[name] = str(error)
        found.append(row)
    return found


def _errors(content: Poses, method: Method, count: int, file: Path) -> list[float]:
    """The mean error of each pose."""
    from neuralmls_research.experiments.poses import pose_errors

    try:
        return pose_errors(content, method, count)
    except ArgumentError as error:
        raise FileError(f"{file}: {error}") from None


def _numbers(text: str) -> list[int]:
    try:
        numbers = [int(number) for number in text.split(",")]
    except ValueError:
        numbers = []
    if not numbers or min(numbers) < 1:
        raise ArgumentError(f"--counts: expected whole numbers above 0 with commas between, found '{text}'")
    return numbers
