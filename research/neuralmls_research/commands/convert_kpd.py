"""`neuralmls convert-kpd`: published weights of KeypointDeformer for `neuralmls_research.baselines`."""

from __future__ import annotations

import sys
from pathlib import Path

import click

from neuralmls.cli.plugin import console, options, outputs


@click.command("convert-kpd")
@click.argument("checkpoint", type=options.PATH)
@options.output("The .safetensors file to write.")
@options.quiet
@options.force
def convert_kpd(*, checkpoint: Path, output: Path, quiet: bool, force: bool) -> None:
    """Convert published weights of KeypointDeformer.

    A PyTorch file can hold any program. It is read as data: nothing in it is executed,
    and what is no tensor is refused.
    """
    outputs.check_ending(output, ("safetensors",), "weights")
    outputs.check_output(output, force=force, inputs=[checkpoint])

    from neuralmls_research.baselines.kpd.checkpoint import convert

    count = convert(checkpoint, output)
    if not quiet:
        console.line(f"{output}: KeypointDeformer with {count} keypoints", sys.stdout)
