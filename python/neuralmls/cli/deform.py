"""`neuralmls deform`: a shape, control points, and the same file with its shape bent."""

from __future__ import annotations

import sys
from collections.abc import Sequence
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
    offsets = _offsets(moves)
    to_stdout = output == outputs.STANDARD_OUTPUT
    if not to_stdout:
        outputs.check_output(output, force=force, inputs=[shape, points])

    from neuralmls.arrays import as_number
    from neuralmls.cli import deformation, summary
    from neuralmls.cli.session import Settings, with_session
    from neuralmls.control_points import ControlPoints
    from neuralmls.shape import read

    as_number("temperature", temperature, 0)
    choice.check()
    stages = Stages(quiet=quiet)
    with stages.stage("read"):
        source = read(shape)
        if not to_stdout:
            outputs.check_ending(output, source.extensions, f"a bent {source.format} file (formats are not converted)")
        deformation.check_size(source)
        control_points = ControlPoints.read(points).moved(offsets)
        given = Settings(choice, temperature, transform, 0.0 if exact is False else 1.0, careful=exact is None)
        settings = with_session(given, points)
    warnings = deformation.check_points(control_points, points, source)
    moved = bool((control_points.sources != control_points.targets).any())
    if moved and not to_stdout:
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
    elif exact:  # which the advice says too
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


def _offsets(moves: Sequence[str]) -> dict[str, list[float]]:
    """What `--move NAME=dx,dy,dz` says; a name may have = in it."""
    offsets: dict[str, list[float]] = {}
    for text in moves:
        name, equals, numbers = text.rpartition("=")
        try:
            offset = [float(number) for number in numbers.split(",")]
        except ValueError:
            offset = []
        if not equals or not name or not offset:
            raise ArgumentError(f"--move: expected NAME=dx,dy,dz, found '{text}'")
        if name in offsets:
            raise ArgumentError(f"--move: '{name}' is moved twice")
        offsets[name] = offset
    return offsets


def _check_side_files(shape: Shape, output: Path, *, force: bool) -> None:
    """Refuse buffers of a glTF file that are to be written beside the output and are there already."""
    first = output.with_suffix(".bin")
    if shape.format != "glTF" or force or not first.is_file():
        return
    for name in shape.encode(shape.positions / 2, stem=output.stem)[1]:  # whatever the positions, if they are others
        outputs.check_output(output.parent / name, force=force)


def _write(shape: Shape, result: Deformation, output: Path, *, force: bool) -> tuple[list[str], list[str]]:
    """Write the shape; return the files written, and warnings of files beside it that were kept."""
    if output == outputs.STANDARD_OUTPUT:
        data, side_files = shape.encode(result.positions, maps=result.maps)
        if side_files:
            raise ArgumentError(
                f"standard output takes one file, but this {shape.format} is written with '{next(iter(side_files))}' "
                "beside it: name an output file"
            )
        sys.stdout.buffer.write(data)
        sys.stdout.buffer.flush()
        return [], []
    return outputs.write_shape(shape, output, result.positions, maps=result.maps, force=force)
