"""The methods that the paper compares with, and two that users know: each is one call, `baseline(shape, p, q)`.

All take the same arguments and return the same thing, so that a comparison needs to know only their names:

`shape : neuralmls.Shape`, `p, q : (m, 3)`, the control points at rest and moved, in the coordinates of the file
-> `(n, 3) float64`, the positions of the vertices. Unmoved control points return the positions bit for bit. Where
a method has conditions that the shape does not meet, it raises `NotApplicable`, whose sentence says which.

All but `classic` need the extra `baselines` (libigl, SciPy, safetensors), which is imported when a method runs.

>>> NAMES
('classic', 'arap', 'kpd', 'rbf', 'biharmonic')
>>> get("classic").__name__
'classic'
"""

from __future__ import annotations

import difflib
from collections.abc import Callable
from importlib import import_module
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from neuralmls.errors import ArgumentError

Baseline: TypeAlias = Callable[..., NDArray[np.float64]]

TITLES = {
    "classic": "Classic MLS",
    "arap": "ARAP",
    "kpd": "KeypointDeformer",
    "rbf": "RBF",
    "biharmonic": "Biharmonic weights",
}
NAMES = tuple(TITLES)
_HOMES = {name: f"neuralmls.baselines.{name}" for name in NAMES} | {"kpd": "neuralmls.baselines.kpd.baseline"}


def get(name: str) -> Baseline:
    """Return the baseline of a name: one of `NAMES`.

    Raises
    ------
    ArgumentError
        There is no such baseline.
    """
    if name not in NAMES:
        nearest = difflib.get_close_matches(str(name), NAMES, n=1, cutoff=0.0)[0]
        raise ArgumentError(f"there is no baseline '{name}'; the nearest name is '{nearest}'")
    function: Baseline = getattr(import_module(_HOMES[name]), name)
    return function
