"""molesq: affine moving least squares with weights 1/d^2, in NumPy."""

from __future__ import annotations

import numpy as np
from molesq import Transformer
from numpy.typing import NDArray

Array = NDArray[np.float64]


def affine(x: Array, p: Array, q: Array) -> Array:
    """Weights and positions, in one call, as its users do it."""
    y: Array = Transformer(p, q).transform(x)
    return y
