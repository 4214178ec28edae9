"""What the seed of a training changes: means and deviations, and which seeds put methods into another order."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from statistics import fmean, stdev
from typing import Any


@dataclass(frozen=True)
class OtherOrder:
    """Two methods of which one is better on the mean over seeds, and the other with some of the seeds.

    Attributes
    ----------
    better, worse : str
        The methods' names; smaller is better.
    seeds : tuple of int
        Those with which it is the other way round.
    """

    better: str
    worse: str
    seeds: tuple[int, ...]


def other_orders(values: Mapping[str, Sequence[float]], seeds: Sequence[int]) -> list[OtherOrder]:
    """Return the pairs of methods whose order hangs on the seed.

    Parameters
    ----------
    values : methods' names -> a value for each seed, or one value where there is nothing random

    Examples
    --------
    >>> other_orders({"neural": [1.0, 3.0, 1.5], "classic": [2.0]}, [0, 1, 2])
    [OtherOrder(better='neural', worse='classic', seeds=(1,))]
    """
    found = []
    spread = {name: list(own) * len(seeds) if len(own) == 1 else list(own) for name, own in values.items()}
    for pair in combinations(spread, 2):
        better, worse = sorted(pair, key=lambda name: fmean(spread[name]))
        swapped = tuple(seed for seed, a, b in zip(seeds, spread[better], spread[worse], strict=True) if a > b)
        if swapped:
            found.append(OtherOrder(better, worse, swapped))
    return found


def mean_of(documents: Sequence[Any]) -> Any:
    """Return the mean of nested documents of numbers, field by field; None where one of them has no number.

    What is the same in all, as a count of what was left out, is kept as it is.

    >>> mean_of([{"a": 1, "b": {"c": 2}, "d": 7}, {"a": 2, "b": None, "d": 7}])
    {'a': 1.5, 'b': None, 'd': 7}
    """
    return _by_field(documents, lambda values: values[0] if len(set(values)) == 1 else fmean(values))


def deviation_of(documents: Sequence[Any]) -> Any:
    """Return the sample's standard deviation of nested documents, field by field, as `mean_of` does.

    >>> deviation_of([{"a": 1.0}, {"a": 3.0}])
    {'a': 1.4142135623730951}
    """
    return _by_field(documents, stdev)


def _by_field(documents: Sequence[Any], figure: Any) -> Any:
    if any(document is None for document in documents):
        return None
    if isinstance(documents[0], dict):
        return {name: _by_field([document[name] for document in documents], figure) for name in documents[0]}
    return figure(documents)
