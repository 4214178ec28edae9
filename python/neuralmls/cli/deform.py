"""`neuralmls deform`: a shape, control points, and the same file with its shape bent."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Literal, TypeAlias, get_args

import click

from neuralmls.cli import console, options, outputs
from neuralmls.cli.stages import Stages
from neuralmls.cli.weights import WeightsChoice, weights_options
from neuralmls.errors import ArgumentError

if TYPE_CHECKING:
    from neuralmls.cli.deformation import Deformation
    from neuralmls.shape import Shape

TransformName: TypeAlias = Literal["rigid", "similarity", "affine"]


@click.command()
@options.shape
@options.points("The control points and their targets, JSON or CSV.")
@options.output("The file to write, of the shape's format; - for standard output.")
@weights_options
@click.option(
    "--transform",
    type=click.Choice(get_args(TransformName)),
    default="rigid",
    help="What may happen to the shape locally.",
)
@click.option(
    "--move",
    "moves",
    metavar="NAME=DX,DY,DZ",
    multiple=True,
    help="Move a target, from where the file has it; may be repeated.",
)
@click.option(
    "--turn",
    "turns",
    metavar="NAME=AXIS,DEGREES",
    multiple=True,
    help="Turn a control point, and what is near it, about x, y, z or an axis of three numbers; may be repeated.",
)
@click.option(
    "--exact/--no-exact",
    default=None,
    help="Take the control points all the way to their targets, at any price, or only near them. "
    "If not given: all the way where they own their places and arrive, else near.",
)
@click.option("--check", is_flag=True, help="Say where the result is likely bad, and what would help.")
@options.json
@options.quiet
@click.option("--verbose", is_flag=True, help="Every control point in the summary.")
@options.force
def deform(
    *,
    shape: Path,
    points: Path,
    output: Path,
    choice: WeightsChoice,
    temperature: float,
    transform: TransformName,
    moves: Sequence[str],
    turns: Sequence[str],
    exact: bool | None,
    check: bool,
    json: bool,
    quiet: bool,
    verbose: bool,
    force: bool,
) -> None:
    """Bend a shape by its control points.

    Writes the same file with new positions. Everything else in the file is carried over;
    unmoved control points give the very same bytes. What a session of the editor sets
    (weights, transform, temperature, adherence) holds where no option says otherwise.

    Example: neuralmls deform chair.obj --points chair.json -o bent.obj
    """
    offsets = dict(_offsets(moves))
    axes = dict(_axes(turns))
    to_stdout = output == outputs.STANDARD_OUTPUT
    if not to_stdout:
        outputs.check_output(output, force=force, inputs=[shape, points])

    from neuralmls.arrays import as_number
    from neuralmls.cli import deformation, summary
    from neuralmls.cli.session import Settings, with_session
    from neuralmls.control_points import ControlPoints
    from neuralmls.shape import read
    from neuralmls.turns import Turn

    as_number("temperature", temperature, 0)
    choice.check()
    stages = Stages(quiet=quiet)
    with stages.stage("read"):
        source = read(shape)
        if not to_stdout:
            outputs.check_ending(output, source.extensions, f"a bent {source.format} file (formats are not converted)")
        deformation.check_size(source)
        control_points = ControlPoints.read(points).moved(offsets)
        control_points = control_points.turned({name: Turn(tuple(axis), angle) for name, (axis, angle) in axes.items()})
        given = Settings(choice, temperature, transform, 0.0 if exact is False else 1.0, careful=exact is None)
        settings = with_session(given, points)
    warnings = deformation.check_points(control_points, points, source)
    moved = bool((control_points.sources != control_points.targets).any()) or control_points.is_turned
    if moved:
        _check_side_files(source, output, force=force)
    if not moved:
        warnings.append("no control point is moved, so that the output is the input")
    for sentence in warnings:
        console.warning(sentence)
    result = deformation.deformed(source, control_points, settings, stages)
    sentences = deformation.not_parted(control_points, settings.choice, result)
    advice = []
    if check:
        with stages.stage("check"):
            advice = deformation.advice(source, control_points, result, settings)
    else:  # the advice says it too
        sentences += deformation.not_arrived(control_points, source, result)
    for sentence in sentences:
        console.warning(sentence)
        warnings.append(sentence)
    for item in advice:
        console.warning(item.sentence)
    with stages.stage("write"):
        files, kept = _write(source, result, output, force=force)
    for sentence in kept:
        console.warning(sentence)
        warnings.append(sentence)
    told = summary.summary(source, control_points, settings, result)
    told |= {"output": str(output), "files": files, "warnings": warnings, "seconds": stages.seconds}
    if check:
        told["advice"] = [asdict(item) for item in advice]
    out = sys.stderr if to_stdout else sys.stdout
    if json:
        console.document(told, out)
    elif not quiet:
        summary.show(told, everything=verbose, file=out)


def _offsets(moves: Sequence[str]) -> Iterator[tuple[str, list[float]]]:
    """What `--move NAME=dx,dy,dz` says."""
    for name, numbers, text in _named("--move", "moved", moves):
        try:
            yield name, [_number(number) for number in numbers]
        except ValueError:
            raise ArgumentError(f"--move: expected NAME=dx,dy,dz, found '{text}'") from None


def _axes(turns: Sequence[str]) -> Iterator[tuple[str, tuple[list[float], float]]]:
    """The axis, of 3 numbers or none, and the degrees that `--turn NAME=AXIS,DEGREES` says."""
    axes = {"x": [1.0, 0.0, 0.0], "y": [0.0, 1.0, 0.0], "z": [0.0, 0.0, 1.0]}
    for name, (*letters, degrees), text in _named("--turn", "turned", turns):
        try:
            known = axes.get("".join(letters)) or [_number(number) for number in letters]
            if len(known) not in (0, 3):
                raise ValueError
            yield name, (known, _number(degrees))
        except ValueError:
            expected = "NAME=AXIS,DEGREES with the axis x, y, z or three numbers (none in the plane)"
            raise ArgumentError(f"--turn: expected {expected}, found '{text}'") from None


def _named(option: str, done: str, texts: Sequence[str]) -> Iterator[tuple[str, list[str], str]]:
    """Name and numbers of each `NAME=NUMBERS`; a name may have = in it."""
    seen = set()
    for text in texts:
        name, _, numbers = text.rpartition("=")
        if name in seen:
            raise ArgumentError(f"{option}: '{name}' is {done} twice")
        seen.add(name)
        yield name, numbers.split(",") if name else ["no name"], text


def _number(text: str) -> float:
    """A number as a person writes it: Python would read 1_000 as one, too."""
    if "_" in text:
        raise ValueError
    return float(text)


def _check_side_files(shape: Shape, output: Path, *, force: bool) -> None:
    """Refuse files that are to be written beside the output, where they are there already or there is no such place."""
    if output == outputs.STANDARD_OUTPUT:
        for name in shape.side_files(shape.path.stem):
            raise ArgumentError(
                f"standard output takes one file, but this {shape.format} is written with '{name}' beside it: "
                "name an output file"
            )
    for name in shape.side_files(output.stem):
        outputs.check_output(output.parent / name, force=force)


def _write(shape: Shape, result: Deformation, output: Path, *, force: bool) -> tuple[list[str], list[str]]:
    """Write the shape; return the files written, and warnings of files beside it that were kept."""
    if output == outputs.STANDARD_OUTPUT:
        data, _ = shape.encode(result.positions, maps=result.maps)
        sys.stdout.buffer.write(data)
        sys.stdout.buffer.flush()
        return [], []
    return outputs.write_shape(shape, output, result.positions, maps=result.maps, force=force)
