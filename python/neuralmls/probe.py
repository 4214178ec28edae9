"""A deformation looked at closely, at places all over the shape, in several settings."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias, TypedDict

import numpy as np
from numpy.typing import ArrayLike, NDArray

from neuralmls.arrays import as_points, box_around
from neuralmls.deformer import Deformer
from neuralmls.errors import ArgumentError
from neuralmls.exact import ExactHandles
from neuralmls.metrics import beside, jacobians
from neuralmls.placement import sample_surface
from neuralmls.protocol import Transform, Weights
from neuralmls.turns import Rotations, Scales
from neuralmls.weights.softmax import softmax

Array: TypeAlias = NDArray[np.float64]

# So many places on the shape, and differences over this part of the longest side, so that a band too narrow for the
# places to lie in is still seen from its sides.
PLACES, STEP = 4000, 2.5e-3
# A stretch may be so many times that of most of the shape.
STRETCH = 4.0
# Everything moves as one if the Jacobians differ by no more.
ALIKE = 1e-6


@dataclass(frozen=True)
class Motion:
    """What a deformation does at the places: where they go (k, d), and the Jacobians there (k, d, d)."""

    positions: Array
    jacobians: Array

    def alike(self) -> bool:
        """Whether everything moves as one."""
        return bool(np.ptp(self.jacobians, axis=0).max() < ALIKE)

    def turned(self) -> Array:
        """The determinants, (k,)."""
        determinants: Array = np.linalg.det(self.jacobians)
        return determinants

    def stretch(self) -> Array:
        """The greatest stretch at each place, in that of most places if that is above 1, (k,)."""
        stretch = np.linalg.norm(self.jacobians, ord=2, axis=(1, 2))
        relative: Array = stretch / max(1.0, float(np.median(stretch)))
        return relative

    def folded_part(self) -> float:
        """The part of the places that are turned inside out."""
        return float((self.turned() <= 0).mean())

    def torn_part(self) -> float:
        """The part of the places that are stretched beyond `STRETCH`."""
        return float((self.stretch() > STRETCH).mean())


class _Turns(TypedDict):
    """What control points carry besides their targets, as `Deformer.deform` takes it."""

    rotations: Rotations
    scales: Scales


class Probe:
    """Places on a shape, bound to the weights of control points that have targets.

    Parameters
    ----------
    x : (n, d), faces : (f, 3) integers or None, weights : Weights, targets : (m, d), transform : Transform
    rotations : (m, d, d), scales : (m,), optional
        As `neuralmls.advise` has them.

    Raises
    ------
    ArgumentError
        There are no points, or an argument does not fit another.
    """

    def __init__(
        self,
        x: ArrayLike,
        faces: ArrayLike | None,
        weights: Weights,
        targets: ArrayLike,
        transform: Transform = "rigid",
        *,
        rotations: Rotations = None,
        scales: Scales = None,
    ) -> None:
        self.p = as_points("weights.control_points", weights.control_points)
        points = as_points("x", x, self.p.shape[1])
        if not len(points):
            raise ArgumentError("x: expected at least one point, found none")
        self.q = as_points("targets", targets, points.shape[1])
        self.transform = transform
        self._turns: _Turns = {"rotations": rotations, "scales": scales}
        self.side = 2 * box_around(points)[1]
        self.places = _places(points, faces)
        self._weights = weights
        self._exact = ExactHandles(weights, transform=transform)
        self._deformer = Deformer(self.places, weights, transform=transform)
        self._step = STEP * self.side
        self._beside = [Deformer(place, weights, transform=transform) for place in beside(self.places, self._step)]

    def motion(self, temperature: float, adherence: float) -> Motion:
        """What the deformation does at the places."""
        aimed = self._exact.aim(self.q, temperature, adherence, **self._turns).targets
        deformed, *values = (
            np.asarray(deformer.deform(aimed, temperature, **self._turns), np.float64)
            for deformer in (self._deformer, *self._beside)
        )
        return Motion(deformed, jacobians(values, self._step))

    def missed(self, transform: Transform, temperature: float, adherence: float) -> Array:
        """How far each control point ends from its target, (m,)."""
        exact = ExactHandles(self._weights, transform=transform)
        aimed = exact.aim(self.q, temperature, adherence, **self._turns).targets
        arrived = Deformer(self.p, self._weights, transform=transform).deform(aimed, temperature, **self._turns)
        return np.asarray(np.linalg.norm(arrived - self.q, axis=1))

    def weight(self, place: int, temperature: float) -> Array:
        """The weights of the control points at a place, (m,)."""
        weights: Array = softmax(self._weights.logits(self.places[place : place + 1]), temperature)[0]
        return weights

    def far(self) -> tuple[Array, NDArray[np.int64]]:
        """How far each place is from the nearest control point, and which that is.

        The distance is in the median distance of a control point to the next one; 0 if there is but one.
        """
        distance, nearest = _nearest(self.places, self.p)
        if len(self.p) < 2:
            return 0 * distance, nearest
        spacing = np.median([_nearest(p[None], np.delete(self.p, i, 0))[0] for i, p in enumerate(self.p)])
        return distance / spacing, nearest


def _places(x: Array, faces: ArrayLike | None) -> Array:
    """Places to look at (k, d): on the surface by area, or points of the cloud."""
    samples = x[:0] if faces is None else sample_surface(x, faces, PLACES)
    if len(samples):
        return samples
    return x if len(x) <= PLACES else x[np.sort(np.random.default_rng(0).permutation(len(x))[:PLACES])]


def _nearest(x: Array, p: Array) -> tuple[Array, NDArray[np.int64]]:
    """The distance to the nearest of the points `p`, and which it is, for each of `x`."""
    distances = np.stack([np.linalg.norm(x - point, axis=1) for point in p])
    return distances.min(axis=0), distances.argmin(axis=0)
