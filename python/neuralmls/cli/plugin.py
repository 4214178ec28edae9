"""What the commands of other packages are made of.

Such a package names its commands in the entry points `neuralmls.commands`: `name = "package.module:command"`, a command
of Click's. `neuralmls` lists the names, and imports a command when it is asked for.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from neuralmls.cli import console, inputs, options, outputs
from neuralmls.cli.stages import Stages

if TYPE_CHECKING:
    from neuralmls.control_points import ControlPoints
    from neuralmls.shape import Shape

__all__ = ["Stages", "check_inputs", "console", "options", "outputs"]


def check_inputs(shape: Shape, points: ControlPoints, file: Path) -> list[str]:
    """Return warnings of control points, read from `file`, that lie far outside of a shape.

    Raises
    ------
    FileError
        The shape has no size to measure by.
    ControlPointError
        The control points have another dimension than the shape, or are nowhere near anything.
    """
    inputs.check_size(shape)
    return inputs.check_points(points, file, shape)
