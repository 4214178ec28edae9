"""`neuralmls fit`: the weights of control points, fitted once and kept, for any number of shapes."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from shlex import quote
from typing import Any

import click

from neuralmls.cli import console, inputs, options, outputs, settings
from neuralmls.cli.stages import Stages
from neuralmls.errors import ArgumentError


@click.command()
@options.shapes
@options.session
@options.output("The map to write.")
@settings.settings_options(*settings.WEIGHTS, *settings.MOTION)
@options.quiet
@options.force
def fit(
    *,
    shapes: Sequence[Path],
    points: Path | None,
    targets: Path | None,
    by_order: bool,
    output: Path,
    said: dict[str, Any],
    quiet: bool,
    force: bool,
) -> None:
    """Fit weights to control points, and keep them as a map.

    The map is of space: it bends any shape, point list or cloud in the coordinates of these shapes, always in the
    same way. Its targets are those of the file; others can be given when it is used.

    Example: neuralmls fit body.obj shirt.obj --points pose.json -o body.map
    """
    if points is None:
        raise ArgumentError("--points: expected a file of control points")
    given = [path for path in (*shapes, points, targets) if path is not None]
    inputs.one_standard_input(given)
    outputs.check_output(output, force=force, inputs=given)
    stages = Stages(quiet=quiet)
    session = inputs.settings_of(said, inputs.read_session(points, targets, by_order=by_order))
    read = [inputs.read_shape(path, sized=session.frame is None) for path in shapes]
    for shape in read:
        inputs.check_points(session.points, points, shape)
    for sentence in [*session.notes, *inputs.check_together(session.points, read, session.frame)]:
        console.warning(sentence)
    with stages.stage("train") as report:
        map = session.fit(*read, progress=report)
    map.save(output)
    for sentence in map.report().warnings:
        console.warning(sentence)
    if not quiet:
        count = len(session.points)
        console.line(f"{output}: a map of {count:,} control points, {session.weights} weights", sys.stdout)
        tried = f"{quote(str(shapes[0]))} --map {quote(str(output))} -o bent{shapes[0].suffix}"
        console.line(f"Try: neuralmls deform {tried}", sys.stdout)
