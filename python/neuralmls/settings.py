"""Settings of a session as keywords: handed on as a session file has them, since the core checks those."""

from __future__ import annotations

import json
import math
from typing import Any, Literal, TypeAlias

import numpy as np

from neuralmls.errors import ArgumentError

WeightsName: TypeAlias = Literal["neural", "shape-aware", "inverse-distance"]
Handles: TypeAlias = Literal["auto", "exact", "soft"] | float

PARAMETERS = ("width", "steps", "seed", "rate", "fourier_sigma", "alpha", "epsilon")


def changes_of(weights: str | None, parameters: dict[str, float | None], **others: Any) -> str:
    """The settings as the session file has them; the core refuses what is wrong with them."""
    unknown = parameters.keys() - set(PARAMETERS)
    if unknown:
        raise TypeError(f"unexpected keyword argument '{min(unknown)}'")
    changes = {name: _plain(name, value) for name, value in others.items()}
    chosen = {name: _plain(name, value) for name, value in parameters.items() if value is not None}
    if weights is not None:
        chosen["kind"] = _plain("weights", weights)
    if chosen:
        changes["weights"] = chosen
    return json.dumps(changes)


def _plain(name: str, value: Any) -> Any:
    """A number or name as JSON can hold it; the core says what is wrong with any other."""
    plain = value.item() if isinstance(value, np.generic) else value
    if not isinstance(plain, (str, int, float)) or (isinstance(plain, float) and not math.isfinite(plain)):
        raise ArgumentError(f"{name}: expected a finite number or a name, found {value!r}")
    return plain
