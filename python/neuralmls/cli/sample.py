"""`neuralmls sample`: a shape made by code, with control points, to try things on."""

from __future__ import annotations

import sys
from pathlib import Path
from shlex import quote

import click

from neuralmls.cli import console, options, outputs


@click.command()
@click.argument("name", metavar="chair|airplane|car|table")
@options.output("The OBJ file to write.")
@options.quiet
@options.force
def sample(*, name: str, output: Path, quiet: bool, force: bool) -> None:
    """Write a sample shape and its control points."""
    outputs.check_ending(output, ("obj",), "a sample")
    files = sample_files(output)
    for file in files:
        outputs.check_output(file, force=force)
    write_sample(name, output)
    if not quiet:
        console.line(f"{files[0]}: the {name}, with {files[1].name} and its control points {files[2].name}", sys.stdout)
        console.line(
            f"Try: neuralmls deform {quote(str(files[0]))} --points {quote(str(files[2]))} "
            f"-o {quote(str(output.with_stem(output.stem + '-moved')))}",
            sys.stdout,
        )


def sample_files(output: Path) -> tuple[Path, Path, Path]:
    """The files of a sample: shape, materials, control points."""
    return output, output.with_suffix(".mtl"), output.with_suffix(".points.json")


def write_sample(name: str, output: Path) -> None:
    """Make a sample and write its files.

    Raises
    ------
    ArgumentError
        There is no such sample.
    FileError
        A file cannot be written.
    """
    from neuralmls.samples import make
    from neuralmls.samples.sample import write_obj

    made = make(name)
    write_obj(made, output)
    made.control_points.write(sample_files(output)[2])
