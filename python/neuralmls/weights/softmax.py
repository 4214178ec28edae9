"""Logits at a temperature become weights."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from neuralmls.arrays import as_number
from neuralmls.errors import ArgumentError


def softmax(logits: ArrayLike, temperature: float = 1.0) -> NDArray[np.float64]:
    """Return the weights `w = softmax(logits / T)`.

    For looking at weights; `Deformer` has its own, which stays accurate however small T is.

    Parameters
    ----------
    logits : (n, m)
        +infinity (a point on a control point) is a weight of 1.
    temperature : float > 0

    Returns
    -------
    (n, m) float64, rows sum to 1

    Raises
    ------
    ArgumentError
        The temperature is not a number above 0; the logits are no numbers, or there are none to a row.

    Examples
    --------
    >>> softmax([[0.0, np.log(3.0)]]).round(6).tolist()
    [[0.25, 0.75]]
    """
    t = as_number("temperature", temperature, 0)
    try:
        values = np.asarray(logits, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise ArgumentError(f"logits: expected an (n, m) array of numbers: {error}") from error
    if values.ndim == 0 or values.shape[-1] == 0:
        raise ArgumentError(f"logits: expected an (n, m) array with m of at least 1, found shape {values.shape}")
    largest = values.max(axis=-1, keepdims=True)
    with np.errstate(invalid="ignore"):  # infinity less infinity, which is a tie
        below = np.where(values == largest, 0.0, values - largest)
    e = np.exp(below / t)
    weights: NDArray[np.float64] = e / e.sum(axis=-1, keepdims=True)
    return weights
