"""`neuralmls render`: a picture of shapes side by side."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from neuralmls.cli import console, inputs, options, outputs, settings
from neuralmls.cli.stages import Stages
from neuralmls.errors import ArgumentError

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from neuralmls.session import Session
    from neuralmls.shape import Shape


@click.command()
@click.argument("shapes", metavar="SHAPE...", type=options.PATH, nargs=-1, required=True)
@options.output("The picture to write, .png.")
@click.option(
    "--points", type=options.PATH, help="Control points: balls, on the first shape with arrows to the targets."
)
@click.option("--heat", metavar="NAME", help="Colour the first shape by this control point's weight.")
@settings.settings_options(*settings.WEIGHTS)
@options.quiet
@options.force
def render(
    *,
    shapes: Sequence[Path],
    output: Path,
    points: Path | None,
    heat: str | None,
    said: dict[str, Any],
    quiet: bool,
    force: bool,
) -> None:
    """Draw shapes side by side into a picture.

    All are seen by the same camera. The options of the weights are those of deform, and matter
    for --heat only. Needs PyVista: pip install 'neuralmls[figures]', in a checkout
    pip install --editable '.[figures]'
    """
    if heat is not None and points is None:
        raise ArgumentError("--heat names a control point: give the control points with --points")
    outputs.check_ending(output, ("png",), "a picture")
    outputs.check_output(output, force=force, inputs=[*shapes, *([points] if points else [])])

    from neuralmls.figures.render import Panel
    from neuralmls.figures.render import render as draw
    from neuralmls.shape import read

    stages = Stages(quiet=quiet)
    session = None if points is None else inputs.settings_of(said, inputs.read_session(points))
    sources = [read(path) for path in shapes]
    for source in sources:
        inputs.longest_side(source)  # refuses what has no size that a number could hold
    if session is not None:
        for sentence in inputs.check_points(session.points, points, sources[0]):
            console.warning(sentence)
    values: list[NDArray[np.float64] | None] = [None] * len(sources)
    if session is not None and heat is not None:
        values[0] = _weights_of(heat, sources[0], session, stages)
    panels = [
        Panel(visible, source.positions, source.faces, weights=value)
        for visible, source, value in zip(_titles(shapes), sources, values, strict=True)
    ]
    draw(panels, output, control_points=None if session is None else session.points)
    if not quiet:
        console.line(f"{output}: {', '.join(_titles(shapes))}", sys.stdout)


def _weights_of(name: str, shape: Shape, session: Session, stages: Stages) -> NDArray[np.float64]:
    """The weight of one control point at each vertex."""
    from neuralmls.figures.plots import number_of
    from neuralmls.weights import softmax

    number = number_of(name, session.points.names, "--heat")
    inputs.check_size(shape)
    with stages.stage("train") as report:
        weights = session.fit(shape, progress=report).weights
    with stages.stage("bind") as report:
        logits = weights.logits(shape.positions, progress=report)
        return softmax(logits, session.settings["temperature"])[:, number]


def _titles(shapes: Sequence[Path]) -> list[str]:
    """The files' names, with their folder where two have the same name."""
    names = [path.name for path in shapes]
    return [path.name if names.count(path.name) == 1 else str(path) for path in shapes]
