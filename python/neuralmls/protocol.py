"""What a weight function is: anything with these two members can be handed to a `Deformer`."""

from __future__ import annotations

from typing import Literal, Protocol, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from neuralmls.arrays import Progress

Transform: TypeAlias = Literal["rigid", "similarity", "affine"]


class Weights(Protocol):
    """A weight function of m control points, given by its logits."""

    @property
    def control_points(self) -> NDArray[np.float64]:
        """The control points at rest, (m, d)."""

    def logits(self, x: ArrayLike, *, progress: Progress | None = None) -> NDArray[np.float32]:
        """What it says of each of the points `x` (n, d), before the softmax: (n, m)."""
