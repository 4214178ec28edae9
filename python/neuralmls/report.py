"""What a deformation did to its control points, and what is likely bad about it; crates/session makes the sentences."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Report:
    """What happens to the control points, and what a person should know of it.

    Attributes
    ----------
    names : m strings
    moved : (m,) float64
        How far each target is from its control point at rest.
    distance_to_target : (m,) float64
        How far each ends from its target, in the file as it is written.
    orientations : m times (degrees, degrees that are missing, scale), or None of those that only move
    handles : str
        How closely they were met, in a few words.
    soft : str or None
        Why all were left soft although more was asked for, and what would help.
    not_arrived : str or None
        The one of the warnings that control points do not arrive, which advice of kind "misses" says too.
    warnings : tuple of str
    steps : int
        How many steps the map takes: 1 without `no_folds`.
    least : float or None
        With `no_folds`: the least `det J` of the map on the shape and around it, at places other than those of the
        search for steps; 0 or less where space is turned inside out.
    folded : float or None
        With `no_folds`: which part of the shape folds over all the same.
    """

    names: tuple[str, ...]
    moved: NDArray[np.float64]
    distance_to_target: NDArray[np.float64]
    orientations: tuple[tuple[float, float, float] | None, ...]
    handles: str
    soft: str | None
    not_arrived: str | None
    warnings: tuple[str, ...]
    steps: int
    least: float | None
    folded: float | None


@dataclass(frozen=True)
class Advice:
    """One thing that is likely bad about a deformation.

    Attributes
    ----------
    kind : "misses", "stiff", "folds", "torn" or "ungoverned"
    sentence : str
        What is likely bad, where, and what would help.
    where : tuple of d floats
        The worst place, at rest.
    control_points : tuple of str
        The names of those that it is about, the worst first.
    amount : float
        How bad: the greatest distance from a target (misses), how far a control point ends from its target where the
        others alone take it (stiff), the part of the shape (folds), the greatest stretch (torn), the distance to the
        nearest control point (ungoverned).
    """

    kind: Literal["misses", "stiff", "folds", "torn", "ungoverned"]
    sentence: str
    where: tuple[float, ...]
    control_points: tuple[str, ...]
    amount: float


@dataclass(frozen=True)
class Look:
    """A map looked at in places all over a shape.

    Attributes
    ----------
    places, positions : (k, d) float64
        Where they are at rest, and where they go.
    determinants : (k,) float64
        `det J` of the map's Jacobian; 0 or less where space is turned inside out.
    stretches : (k,) float64
        The greatest stretch, in that of most places if that is above 1.
    spacings : (k,) float64
        How far each is from the nearest control point, in the median distance of a control point to the next one.
    """

    places: NDArray[np.float64]
    positions: NDArray[np.float64]
    determinants: NDArray[np.float64]
    stretches: NDArray[np.float64]
    spacings: NDArray[np.float64]
