"""`neuralmls convert-kpd`: published weights of KeypointDeformer for `neuralmls.baselines`."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

import typer

from neuralmls.cli import console, outputs


def convert_kpd(
    checkpoint: Annotated[Path, typer.Argument(metavar="CHECKPOINT", help="The published PyTorch file, .pth or .pt.")],
    output: Annotated[Path, typer.Option("--output", "-o", help="The .safetensors file to write.")],
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Say nothing.")] = False,
    force: Annotated[bool, typer.Option("--force", help="Overwrite files that are there.")] = False,
) -> None:
    """Convert weights of KeypointDeformer.

    Such a file can hold any program. It is read as data: nothing in it is executed, and what is no tensor is refused.
    """
    outputs.check_ending(output, ("safetensors",), "weights")
    outputs.check_output(output, force=force, inputs=[checkpoint])

    from neuralmls.baselines.kpd.checkpoint import convert

    count = convert(checkpoint, output)
    if not quiet:
        console.line(f"{output}: KeypointDeformer with {count} keypoints", sys.stdout)
