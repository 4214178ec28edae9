"""What the errors of `benchmark poses` say: each of our methods against the best rival of each file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from math import exp, log
from statistics import fmean

import numpy as np

from neuralmls_research.experiments.bootstrap import SMALLEST, Ratio, ratio
from neuralmls_research.experiments.seeds import OtherOrder, other_orders


@dataclass(frozen=True)
class Measured:
    """What methods reach on a file, with a number of control points.

    Attributes
    ----------
    file : str
    control_points : int
    errors : dict of names to (seeds, poses)
        The mean error of each pose for each seed, a row where nothing is random. Without those that cannot do the file.
    not_applicable : dict
        Why a method cannot do the file, by its name.
    """

    file: str
    control_points: int
    errors: dict[str, list[list[float]]]
    not_applicable: dict[str, str] = field(default_factory=dict)

    def mean(self, name: str) -> float | None:
        """The mean over seeds and poses."""
        return fmean(map(fmean, self.errors[name])) if name in self.errors else None


def against_rivals(measured: Sequence[Measured], ours: Sequence[str], rivals: Sequence[str]) -> dict[str, Ratio]:
    """Return each of our methods against the best rival of each file, the mean over seeds at each pose.

    A file counts where the method and at least one rival apply to it.
    """
    found = {}
    for name in ours:
        files = [row for row in measured if name in row.errors and any(rival in row.errors for rival in rivals)]
        if files:
            theirs = [[_of_poses(row, rival) for rival in rivals if rival in row.errors] for row in files]
            found[name] = ratio([_of_poses(row, name) for row in files], theirs)
    return found


def orders_by_seed(measured: Sequence[Measured], names: Sequence[str], seeds: Sequence[int]) -> list[OtherOrder]:
    """Return the methods whose order hangs on the seed: by the geometric mean of the errors over the files of all."""
    files = [row for row in measured if all(name in row.errors for name in names)]
    if not files or len(seeds) < 2:
        return []
    return other_orders({name: _geometric(files, name) for name in names}, seeds)


def missing(measured: Sequence[Measured], rivals: Sequence[str]) -> dict[str, list[str]]:
    """Return the rivals that cannot do a file, by the file: it is judged without them."""
    absent = {row.file: [name for name in rivals if name not in row.errors] for row in measured}
    return {file: names for file, names in absent.items() if names}


def _of_poses(row: Measured, name: str) -> list[float]:
    return [float(error) for error in np.mean(row.errors[name], axis=0)]


def _geometric(files: Sequence[Measured], name: str) -> list[float]:
    """For each seed."""
    by_seed: Mapping[int, list[float]] = {
        seed: [log(max(fmean(row.errors[name][seed]), SMALLEST)) for row in files]
        for seed in range(len(files[0].errors[name]))
    }
    return [exp(fmean(logarithms)) for logarithms in by_seed.values()]
