"""A deformation looked at closely, at places all over the shape, in several settings (crates/core/src/advice.rs)."""

from __future__ import annotations

from typing import TypeAlias, TypedDict

import numpy as np
from numpy.typing import ArrayLike, NDArray

from neuralmls import _core
from neuralmls.arrays import as_points, box_around
from neuralmls.deformer import Deformer
from neuralmls.errors import ArgumentError
from neuralmls.exact import ExactHandles
from neuralmls.placement import sample_surface
from neuralmls.protocol import Transform, Weights
from neuralmls.turns import Rotations, Scales, as_turns

Array: TypeAlias = NDArray[np.float64]

# So many places on the shape.
PLACES = 4000


class _Turns(TypedDict):
    """What control points carry besides their targets, as `Deformer.deform` takes it."""

    rotations: Rotations
    scales: Scales


class Probe:
    """Places on a shape, bound to the weights of control points that have targets.

    Parameters
    ----------
    x : (n, d), faces : (f, 3) integers or None, weights : Weights, targets : (m, d), transform : Transform
    rotations : (m, d, d), scales : (m,), careful : bool, optional
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
        careful: bool = False,
    ) -> None:
        self.p = as_points("weights.control_points", weights.control_points)
        self.x, self.faces, self.weights, self.transform = as_points("x", x, self.p.shape[1]), faces, weights, transform
        if not len(self.x):
            raise ArgumentError("x: expected at least one point, found none")
        self.q = as_points("targets", targets, self.p.shape[1])
        self.carried: _Turns = {"rotations": rotations, "scales": scales}
        self.turns = as_turns(rotations, scales, *self.p.shape)
        self.side = 2 * box_around(self.x)[1]
        self.places = _places(self.x, faces)
        self.exact = ExactHandles(weights, transform=transform)
        self.careful = careful
        self._aim = self.exact.aim_carefully if careful else self.exact.aim
        self._handles = Deformer(self.p, weights, transform=transform)
        points, own = (
            np.ascontiguousarray(weights.logits(at), np.float32)
            for at in (_core.Probe.points(self.places, self.side), self.p)
        )
        self.core = _core.Probe(self.p, self.places, self.side, points, own, transform, careful)

    def missed(self, temperature: float, adherence: float) -> Array:
        """How far each control point ends from its target, (m,)."""
        aim = self._aim(self.q, temperature, adherence, **self.carried)
        arrived = self._handles.deform(aim.targets, temperature, **self.carried)
        return np.asarray(np.linalg.norm(arrived - self.q, axis=1))


def _places(x: Array, faces: ArrayLike | None) -> Array:
    """Places to look at (k, d): on the surface by area, or points of the cloud."""
    samples = x[:0] if faces is None else sample_surface(x, faces, PLACES)
    if len(samples):
        return samples
    return x if len(x) <= PLACES else x[np.sort(np.random.default_rng(0).permutation(len(x))[:PLACES])]
