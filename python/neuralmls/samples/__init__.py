"""Sample shapes made by code: a chair, an airplane, a car, a table, each with named control points.

They are as manufactured shapes are: several disconnected, overlapping parts, quads and n-gons, materials, texture
coordinates, open sheets, edges that more than two faces share.
"""

from __future__ import annotations

import difflib
from typing import TYPE_CHECKING

from neuralmls.errors import ArgumentError

if TYPE_CHECKING:
    from neuralmls.samples.sample import Sample

NAMES = ("chair", "airplane", "car", "table")


def make(name: str) -> Sample:
    """Make the sample shape of a name: one of `NAMES`.

    Raises
    ------
    ArgumentError
        There is no such sample.
    """
    from importlib import import_module

    if name not in NAMES:
        nearest = difflib.get_close_matches(name, NAMES, n=1, cutoff=0.0)[0]
        raise ArgumentError(f"there is no sample '{name}'; the nearest name is '{nearest}'")
    sample: Sample = import_module(f"neuralmls.samples.{name}").make()
    return sample
