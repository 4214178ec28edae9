"""`neuralmls points`: control points placed on a shape, to start from."""

from __future__ import annotations

import sys
from pathlib import Path
from shlex import quote

import click

from neuralmls.cli import console, inputs, options, outputs


@click.command()
@options.shape
@options.output("The control-point file to write, .json or .csv.")
@click.option("--count", default="12", help="How many, or auto: as many as make much of a difference.")
@click.option("--symmetric", is_flag=True, help="In exact pairs, p1.L and p1.R, by the shape's plane of symmetry.")
@click.option("--seed", type=int, default=0, help="Of what is drawn at random.")
@options.quiet
@options.force
def points(*, shape: Path, output: Path, count: str, symmetric: bool, seed: int, quiet: bool, force: bool) -> None:
    """Place control points on a shape, to start from.

    The ends of the shape come first, then the middles of its parts. Rename them and set their
    targets in the file, or move them with: neuralmls deform --move
    """
    outputs.check_ending(output, ("json", "csv"), "a file of control points")
    outputs.check_output(output, force=force, inputs=[shape])

    from neuralmls.arrays import as_count
    from neuralmls.errors import ArgumentError
    from neuralmls.placement import place

    as_count("seed", seed, 0, 2**64 - 1)
    if count != "auto" and not count.lstrip("-").isdecimal():
        raise ArgumentError(f"count: expected a whole number from 1 to 1000, or auto, found {count}")
    number = None if count == "auto" else as_count("count", int(count), 1, 1000)
    source = inputs.read_shape(shape)
    placed = place(source.positions, source.faces, number, symmetric=symmetric, seed=seed)
    names = placed.points.names
    placed.points.write(output)
    if quiet:
        return
    for many, far in placed.curve:
        console.line(f"{many} control points: {100 * far:.1f} % of the size from the nearest, in the mean", sys.stdout)
    console.line(f"{output}: {len(names)} control points, {names[0]} to {names[-1]}", sys.stdout)
    zeros = ",0" * (placed.points.dimension - 1)
    console.line(
        f"Try: neuralmls deform {quote(str(shape))} --points {quote(str(output))} -o moved{shape.suffix} "
        f"--move {names[0]}={inputs.longest_side(source) / 5:.2g}{zeros}",
        sys.stdout,
    )
