"""A deformation looked at closely, at places all over the shape, in several settings."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from neuralmls.arrays import as_points, box_around
from neuralmls.deformer import Deformer
from neuralmls.errors import ArgumentError
from neuralmls.exact import ExactHandles
from neuralmls.metrics import beside, jacobians
from neuralmls.metrics.triangles import as_triangles
from neuralmls.placement import sample_faces
from neuralmls.protocol import Transform, Weights
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


class Probe:
    """Places on a shape, bound to the weights of control points that have targets.

    Parameters
    ----------
    x : (n, d), faces : (f, 3) integers or None, weights : Weights, targets : (m, d), transform : Transform
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
    ) -> None:
        self.p = as_points("weights.control_points", weights.control_points)
        points = as_points("x", x, self.p.shape[1])
        if not len(points):
            raise ArgumentError("x: expected at least one point, found none")
        self.q = as_points("targets", targets, points.shape[1])
        self.transform = transform
        self.side = 2 * box_around(points)[1]
        self.places = _places(points, faces)
        self._weights = weights
        self.exact = ExactHandles(weights, transform=transform)
        self._deformer = Deformer(self.places, weights, transform=transform)
        self._step = STEP * self.side
        self._beside = [Deformer(place, weights, transform=transform) for place in beside(self.places, self._step)]

    def motion(self, temperature: float, adherence: float) -> Motion:
        """What the deformation does at the places."""
        aimed = self.exact.aim(self.q, temperature, adherence).targets
        values = [np.asarray(deformer.deform(aimed, temperature), np.float64) for deformer in self._beside]
        return Motion(np.asarray(self._deformer.deform(aimed, temperature), np.float64), jacobians(values, self._step))

    def missed(self, transform: Transform, temperature: float, adherence: float) -> Array:
        """How far each control point ends from its target, (m,)."""
        aimed = ExactHandles(self._weights, transform=transform).aim(self.q, temperature, adherence).targets
        arrived = Deformer(self.p, self._weights, transform=transform).deform(aimed, temperature)
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
    rng = np.random.default_rng(0)
    if faces is not None and np.size(faces):
        origin = (x.min(axis=0) + x.max(axis=0)) / 2  # samples keep their digits far from the origin
        _, samples = sample_faces(x - origin, as_triangles(faces, len(x)), PLACES, rng)
        if len(samples):
            places: Array = samples + origin
            return places
    return x if len(x) <= PLACES else x[np.sort(rng.permutation(len(x))[:PLACES])]


def _nearest(x: Array, p: Array) -> tuple[Array, NDArray[np.int64]]:
    """The distance to the nearest of the points `p`, and which it is, for each of `x`."""
    distances = np.stack([np.linalg.norm(x - point, axis=1) for point in p])
    return distances.min(axis=0), distances.argmin(axis=0)
