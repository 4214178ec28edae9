"""How sure a ratio of errors is: a paired bootstrap over files and their poses.

Poses of one file resemble each other, and methods are measured at the same poses. So files are drawn with replacement,
and poses within each drawn file, the same ones for every method; the interval is that of the ratios so found.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from neuralmls.errors import ArgumentError

Array = NDArray[np.float64]

CONFIDENCE = 0.95
RESAMPLES = 10_000
SMALLEST = 1e-12  # an error below this (% of a diagonal) is rounding, and counts as this: a ratio needs no zero


@dataclass(frozen=True)
class Ratio:
    """A method's error against the best rival's.

    Attributes
    ----------
    ratio, low, high : float
        The geometric mean over files, and its confidence interval.
    won, files : int
        On how many of the files the method is better than every rival.
    """

    ratio: float
    low: float
    high: float
    won: int
    files: int


def ratio(
    errors: Sequence[ArrayLike],
    rivals: Sequence[ArrayLike],
    *,
    confidence: float = CONFIDENCE,
    resamples: int = RESAMPLES,
    seed: int = 0,
) -> Ratio:
    """Return the geometric mean over files of `mean(errors) / min over rivals of mean(rival's errors)`.

    Parameters
    ----------
    errors : for each file, (k,) errors at its k poses
    rivals : for each file, (r, k) errors of r rivals at the same poses
        The best rival is another one for each file, and in each resample: the one with the least mean.
    confidence : float, 0 to 1
        Of the interval: percentiles of the resamples. With few files it is somewhat too narrow.
    resamples, seed : int
        The same seed gives the same interval.

    Raises
    ------
    ArgumentError
        There is no file, or its arrays do not fit each other.

    Source
    ------
    Efron, Tibshirani, An Introduction to the Bootstrap, 1993, chapters 8 and 13; Davison, Hinkley, Bootstrap Methods
    and their Application, 1997, section 3.8 for data in groups.

    Examples
    --------
    >>> ratio([[1.0, 2.0], [3.0]], [[[2.0, 4.0]], [[6.0]]])            # half, wherever one looks
    Ratio(ratio=0.5, low=0.5, high=0.5, won=2, files=2)
    """
    ours = [np.asarray(values, dtype=np.float64) for values in errors]
    theirs = [np.asarray(values, dtype=np.float64) for values in rivals]
    _check(ours, theirs)
    log_ratios = np.array([_log_ratio(a, b) for a, b in zip(ours, theirs, strict=True)])
    draw = np.random.default_rng(seed)
    count = len(ours)
    drawn = draw.integers(count, size=(resamples, count))
    found = np.empty(drawn.shape)
    for file, (a, b) in enumerate(zip(ours, theirs, strict=True)):
        where = drawn == file
        poses = draw.integers(len(a), size=(int(where.sum()), len(a)))
        found[where] = _log_ratio(a[poses], b[:, poses])
    tail = (1 - confidence) / 2
    low, high = np.exp(np.quantile(found.mean(axis=1), [tail, 1 - tail]))
    return Ratio(float(np.exp(log_ratios.mean())), float(low), float(high), int((log_ratios < 0).sum()), count)


def _log_ratio(ours: Array, rivals: Array) -> Array:
    """Of means over the last axis, against the least over the first of the rivals'."""
    best = np.maximum(rivals.mean(axis=-1).min(axis=0), SMALLEST)
    logarithm: Array = np.log(np.maximum(ours.mean(axis=-1), SMALLEST) / best)
    return logarithm


def _check(ours: Sequence[Array], rivals: Sequence[Array]) -> None:
    if not ours or len(ours) != len(rivals):
        raise ArgumentError(f"rivals: expected those of at least one file, of {len(ours)}, found {len(rivals)}")
    for number, (a, b) in enumerate(zip(ours, rivals, strict=True)):
        if a.ndim != 1 or b.ndim != 2 or not len(a) or not len(b) or b.shape[1] != len(a):
            raise ArgumentError(
                f"file {number}: expected errors (poses,) and rivals (rivals, poses), found {a.shape} and {b.shape}"
            )
        if not (np.isfinite(a).all() and np.isfinite(b).all() and min(a.min(), b.min()) >= 0):
            raise ArgumentError(f"file {number}: expected finite errors of at least 0")
