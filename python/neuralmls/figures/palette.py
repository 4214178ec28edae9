"""The colours of figures: red, green, blue, 0 to 1."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Colour = tuple[float, float, float]

CLAY = (0.76, 0.79, 0.83)
SOURCE = (0.86, 0.20, 0.18)
TARGET = (0.10, 0.42, 0.85)
INK = (0.16, 0.17, 0.20)

# From clay over amber to dark red: ever darker, so that it reads without colour too.
_HEAT = np.array([(0.84, 0.86, 0.89), (0.98, 0.80, 0.45), (0.95, 0.52, 0.20), (0.76, 0.18, 0.15), (0.36, 0.02, 0.13)])


def heat(weights: NDArray[np.float64]) -> NDArray[np.float64]:
    """Colours (n, 3) of weights (n,) from 0 to 1."""
    knots = np.linspace(0.0, 1.0, len(_HEAT))
    return np.stack([np.interp(weights, knots, _HEAT[:, channel]) for channel in range(3)], axis=-1)
