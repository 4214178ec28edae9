"""`neuralmls points`: control points spread over a shape, to start from."""

from __future__ import annotations

import sys
from pathlib import Path
from shlex import quote

import click

from neuralmls.cli import console, inputs, options, outputs


@click.command()
@options.shape
@options.output("The control-point file to write, .json or .csv.")
@click.option("--count", type=int, default=12, help="How many.")
@click.option("--seed", type=int, default=0, help="Of the samples of the surface.")
@options.quiet
@options.force
def points(*, shape: Path, output: Path, count: int, seed: int, quiet: bool, force: bool) -> None:
    """Spread control points over a shape, to start from.

    Each is as far from the others as can be. Rename them and set their targets in the file,
    or move them with: neuralmls deform --move
    """
    outputs.check_ending(output, ("json", "csv"), "a file of control points")
    outputs.check_output(output, force=force, inputs=[shape])

    from neuralmls.arrays import as_count
    from neuralmls.control_points import ControlPoints
    from neuralmls.placement import farthest_points

    as_count("seed", seed, 0, 2**64 - 1)
    as_count("count", count, 1, 1000)
    source = inputs.read_shape(shape)
    placed = ControlPoints(farthest_points(source.positions, source.faces, count, seed=seed))
    placed.write(output)
    if quiet:
        return
    console.line(f"{output}: {count} control points, {placed.names[0]} to {placed.names[-1]}", sys.stdout)
    zeros = ",0" * (placed.dimension - 1)
    console.line(
        f"Try: neuralmls deform {quote(str(shape))} --points {quote(str(output))} -o moved{shape.suffix} "
        f"--move p1={inputs.longest_side(source) / 5:.2g}{zeros}",
        sys.stdout,
    )
