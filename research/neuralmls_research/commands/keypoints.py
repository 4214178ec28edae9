"""`neuralmls keypoints`: KeypointDeformer's own keypoints as control points, which is how the paper places them."""

from __future__ import annotations

import sys
from pathlib import Path

import click

from neuralmls.cli.plugin import console, options, outputs


@click.command()
@options.shape
@click.option("--weights", metavar="FILE", type=options.PATH, required=True, help="KeypointDeformer's, .safetensors.")
@options.output("The control points: a session (.json) or a table (.csv).")
@options.quiet
@options.force
def keypoints(*, shape: Path, weights: Path, output: Path, quiet: bool, force: bool) -> None:
    """Put control points where KeypointDeformer finds keypoints.

    Its weights are for one category, airplanes or cars, and for shapes that face +x, y up; get them
    as docs/keypoints.md says. Move the control points in the editor, then let compare --kpd show
    what each method makes of it.

    Example: neuralmls keypoints car.obj --weights car.safetensors -o car.points.json
    """
    outputs.check_ending(output, ("json", "csv"), "control points")
    outputs.check_output(output, force=force, inputs=[shape, weights])

    from neuralmls import ControlPoints, read
    from neuralmls_research.baselines.kpd import KeypointDeformer

    network, source = KeypointDeformer.read(weights), read(shape)
    found = network.keypoints(source)
    sides = source.positions.max(axis=0) - source.positions.min(axis=0)
    if sides[0] < sides.max():
        console.warning(
            f"{shape}: keypoints are found on shapes that face +x with y up, and this one is longer along "
            f"{'xyz'[int(sides.argmax())]}: look whether they are where they should be"
        )
    names = [f"keypoint {number}" for number in range(1, len(found) + 1)]
    ControlPoints(found, names=names).write(output)
    if not quiet:
        console.line(f"{output}: {len(found)} control points, which KeypointDeformer found on {shape}", sys.stdout)
