"""The methods that the paper compares with, and others that users know: each is one call, `baseline(shape, p, q)`.

All take the same arguments and return the same thing, so that a comparison needs to know only their names. Their own
docstrings say what is special about each. Unmoved control points return the positions bit for bit.

Parameters
----------
shape : Shape
    In space (for `classic`: of any dimension); what else it has to be, each method says.
p, q : (m, 3)
    Control points at rest and moved, in the coordinates of the file.

Returns
-------
(n, 3) float64, the positions of the vertices

Raises
------
NotApplicable
    The shape or the control points do not meet the method's conditions; the sentence says which.
ArgumentError
    `p` or `q` are no finite points, or not as many as the other.
NeuralMLSError
    A library (libigl, SciPy, safetensors) is not installed. All but `classic` need it; it is
    imported when a method runs.

Examples
--------

>>> NAMES
('classic', 'arap', 'kpd', 'rbf', 'biharmonic', 'biharmonic-displacements')
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
    "biharmonic-displacements": "Biharmonic displacements",
}
NAMES = tuple(TITLES)
_HOMES = {name: f"neuralmls_research.baselines.{name.replace('-', '_')}" for name in NAMES} | {
    "kpd": "neuralmls_research.baselines.kpd.baseline"
}


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
    function: Baseline = getattr(import_module(_HOMES[name]), name.replace("-", "_"))
    return function
