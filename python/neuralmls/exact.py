"""Handles that arrive: effective targets that take each control point all the way to its target."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from neuralmls import _core
from neuralmls.arrays import as_number, as_points
from neuralmls.errors import ArgumentError
from neuralmls.protocol import Transform, Weights
from neuralmls.turns import Rotations, Scales, as_turns


@dataclass(frozen=True)
class Aim:
    """Where to aim so that the control points arrive, and how far each stays away where it cannot.

    Attributes
    ----------
    targets : (m, d) float64
        The effective targets `q'`, to be handed to `Deformer.deform` in the place of the targets.
    misses : (m,) float64
        The distance between where each control point arrives and where it was to go.
    """

    targets: NDArray[np.float64]
    misses: NDArray[np.float64]


class ExactHandles:
    """Solves `f(p_i; q') = q_i` for the effective targets `q'`.

    Moving least squares approximates: a control point goes near its target, not onto it. The weights do not depend on
    the targets, so that one may aim elsewhere. Fixed-point iteration `q' <- q' + (q - f(p; q'))` with Anderson's
    acceleration; unmoved and rigidly moved control points are their own aim.

    Parameters
    ----------
    weights : Weights
        The weight function of the control points.
    transform : "rigid", "similarity" or "affine"
        As the `Deformer` has it.

    Raises
    ------
    ArgumentError
        There is no such transform or weight function.

    Source
    ------
    Anderson, "Iterative procedures for nonlinear integral equations", 1965; Walker, Ni, "Anderson acceleration for
    fixed-point iterations", 2011.

    Examples
    --------
    >>> from neuralmls import Deformer, NeuralWeights
    >>> p, q = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]], [[0.0, 0.0], [1.2, 0.1], [0.0, 1.0]]
    >>> weights = NeuralWeights.fit(p, bounds=[[0, 0], [1, 1]])
    >>> at_handles = Deformer(p, weights)
    >>> bool(abs(at_handles.deform(q) - q).max() > 0.001)             # soft: near the targets
    True
    >>> aim = ExactHandles(weights).aim(q)
    >>> bool(abs(at_handles.deform(aim.targets) - q).max() < 1e-8)    # exact
    True
    """

    def __init__(self, weights: Weights, *, transform: Transform = "rigid") -> None:
        if not hasattr(weights, "control_points"):
            raise ArgumentError(
                f"weights: expected a weight function, with control_points and logits, found {weights!r}"
            )
        self._p = as_points("weights.control_points", weights.control_points)
        logits = np.ascontiguousarray(weights.logits(self._p), np.float32)
        self._core = _core.ExactHandles(self._p, logits, transform)

    def aim(
        self,
        targets: ArrayLike,
        temperature: float = 1.0,
        adherence: float = 1.0,
        *,
        rotations: Rotations = None,
        scales: Scales = None,
    ) -> Aim:
        """Return the effective targets for `targets`.

        Parameters
        ----------
        targets : (m, d)
            Where the control points are to go.
        temperature : float > 0
            Of the softmax, as in `Deformer.deform`.
        adherence : float, 0 to 1
            1: all the way; 0: where plain moving least squares takes them; between: that part of the way between.
        rotations : (m, d, d), scales : (m,), optional
            As in `Deformer.deform`, to which they are to be handed too.

        Raises
        ------
        ArgumentError
            The targets are not as many finite points as there are control points; a number is out of its range.
        """
        q = as_points("targets", targets, self._p.shape[1])
        if len(q) != len(self._p):
            raise ArgumentError(f"targets: expected {len(self._p)} of them, found {len(q)}")
        turns = as_turns(rotations, scales, *q.shape)
        aimed, misses = self._core.aim(q, turns, as_number("temperature", temperature, 0), adherence)
        return Aim(aimed, misses)
