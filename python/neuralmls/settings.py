"""Settings of a session as keywords: handed on as a session file has them, since the core checks those."""

from __future__ import annotations

import json
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
    chosen = {"kind": weights} if weights is not None else {}
    changes = {key: _plain(value) for key, value in others.items()}
    chosen |= {key: _plain(value) for key, value in parameters.items() if value is not None}
    if chosen:
        changes["weights"] = chosen
    try:
        return json.dumps(changes, allow_nan=False)
    except (TypeError, ValueError) as error:
        raise ArgumentError(f"settings: expected finite numbers and names, found {changes!r}: {error}") from None


def _plain(value: Any) -> Any:
    """A number of NumPy's as Python's own."""
    return value.item() if isinstance(value, np.generic) else value
