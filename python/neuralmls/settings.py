"""Settings of a session as keywords: handed on as a session file has them, since the core checks those.

The command line takes the names from here before anything else is imported: numpy is not.
"""

from __future__ import annotations

import json
from numbers import Integral, Real
from typing import Any, Literal, TypeAlias

WeightsName: TypeAlias = Literal["neural", "shape-aware", "inverse-distance"]
# What may happen to a shape locally.
Transform: TypeAlias = Literal["rigid", "similarity", "affine"]
HandlesName: TypeAlias = Literal["auto", "exact", "soft"]
Handles: TypeAlias = HandlesName | float

PARAMETERS = ("width", "steps", "seed", "rate", "fourier_sigma", "alpha", "epsilon")


def changes_of(weights: str | None, parameters: dict[str, float | None], **others: Any) -> str:
    """The settings as the session file has them; the core refuses what is wrong with them."""
    unknown = parameters.keys() - set(PARAMETERS)
    if unknown:
        raise TypeError(f"unexpected keyword argument '{min(unknown)}'")
    changes = dict(others)
    chosen: dict[str, Any] = {name: value for name, value in parameters.items() if value is not None}
    if weights is not None:
        chosen["kind"] = weights
    if chosen:
        changes["weights"] = chosen
    return json.dumps(changes, default=_plain)


def _plain(value: Any) -> Any:
    """A number of another library as JSON can hold it, and the words for anything else, which the core refuses."""
    if isinstance(value, Integral):
        return int(value)
    return float(value) if isinstance(value, Real) else repr(value)
