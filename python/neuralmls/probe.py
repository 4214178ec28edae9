"""A deformation looked at closely, at places all over the shape, in several settings (crates/core/src/advice.rs)."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from neuralmls import _core
from neuralmls.arrays import as_points, box_around
from neuralmls.deformer import Deformer
from neuralmls.errors import ArgumentError
from neuralmls.exact import ExactHandles
from neuralmls.metrics.triangles import as_triangles
from neuralmls.placement import sample_faces
from neuralmls.protocol import Transform, Weights

Array: TypeAlias = NDArray[np.float64]

# So many places on the shape.
PLACES = 4000


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
        self.x, self.faces, self.weights, self.transform = as_points("x", x, self.p.shape[1]), faces, weights, transform
        if not len(self.x):
            raise ArgumentError("x: expected at least one point, found none")
        self.q = as_points("targets", targets, self.p.shape[1])
        self.side = 2 * box_around(self.x)[1]
        self.places = _places(self.x, faces)
        self.exact = ExactHandles(weights, transform=transform)
        self._handles = Deformer(self.p, weights, transform=transform)
        points, own = (
            np.ascontiguousarray(weights.logits(at), np.float32)
            for at in (_core.Probe.points(self.places, self.side), self.p)
        )
        self.core = _core.Probe(self.p, self.places, self.side, points, own, transform)

    def missed(self, temperature: float, adherence: float) -> Array:
        """How far each control point ends from its target, (m,)."""
        aim = self.exact.aim(self.q, temperature, adherence)
        return np.asarray(np.linalg.norm(self._handles.deform(aim.targets, temperature) - self.q, axis=1))


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
