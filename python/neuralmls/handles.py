"""Handles that arrive: effective targets that take each control point all the way to its target."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from neuralmls import _core
from neuralmls.arrays import as_number, as_points
from neuralmls.errors import ArgumentError
from neuralmls.orientations import Rotations, Scales, as_orientations
from neuralmls.settings import Transform
from neuralmls.weights import HasLogits, Weights

Array: TypeAlias = NDArray[np.float64]


@dataclass(frozen=True)
class Soft:
    """Why control points do not arrive.

    Attributes
    ----------
    reason : "shared" or "unreached"
        One has too little of the weight at its own place, so that all are left where plain moving least squares takes
        them; or they are taken as far as it goes without a jump, and one stays off.
    control_point : int
        Which one; of those that stay off, the farthest.
    amount : float
        The weight that it has at its own place, or the distance that it stays off.
    """

    reason: Literal["shared", "unreached"]
    control_point: int
    amount: float


@dataclass(frozen=True)
class Aim:
    """Where to aim so that the control points arrive, and how far each stays away where it cannot.

    Attributes
    ----------
    targets : (m, d) float64
        The effective targets `q'`, to be handed to `Deformer.deform` in the place of the targets.
    misses : (m,) float64
        The distance between where each control point arrives and where it was to go.
    soft : Soft or None
        Why `ExactHandles.aim_carefully` does not take them there; None where it does.
    """

    targets: Array
    misses: Array
    soft: Soft | None = None


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

    def __init__(self, weights: Weights | HasLogits, *, transform: Transform = "rigid") -> None:
        if not hasattr(weights, "control_points"):
            raise ArgumentError(
                f"weights: expected a weight function, with control_points and logits, found {weights!r}"
            )
        self._p = as_points("weights.control_points", weights.control_points)
        logits = np.ascontiguousarray(weights.logits(self._p), np.float32)
        self._core = _core.Handles(self._p, logits, transform)
        self._weights, self._transform = weights, transform

    def __reduce__(self) -> tuple[Any, ...]:
        return _restored, (self._weights, self._transform)

    def aim(
        self,
        targets: ArrayLike,
        temperature: float = 1.0,
        adherence: ArrayLike = 1.0,
        *,
        rotations: Rotations = None,
        scales: Scales = None,
    ) -> Aim:
        """Return the effective targets for `targets`.

        Where the targets cannot be reached these are the best that were found, which may jump while a target moves;
        those of `aim_carefully` do not.

        Parameters
        ----------
        targets : (m, d)
            Where the control points are to go.
        temperature : float > 0
            Of the softmax, as in `Deformer.deform`.
        adherence : float, 0 to 1, or (m,)
            1: all the way; 0: where plain moving least squares takes them; between: that part of the way between. One
            for all, or one for each control point.
        rotations : (m, d, d), scales : (m,), optional
            As in `Deformer.deform`, to which they are to be handed too.

        Raises
        ------
        ArgumentError
            The targets are not as many finite points as there are control points; a number is out of its range.
        """
        checked = self._checked(targets, temperature, rotations, scales)
        aimed, misses, _ = self._core.aim(*checked, as_adherence(adherence, len(self._p)), False)
        return Aim(aimed, misses)

    def aim_carefully(
        self,
        targets: ArrayLike,
        temperature: float = 1.0,
        adherence: ArrayLike = 1.0,
        *,
        rotations: Rotations = None,
        scales: Scales = None,
    ) -> Aim:
        """Return the effective targets where they are worth it, without jumps; else the targets themselves, and why.

        Control points are left soft where one has less than 0.25 of the weight at its own place, so that it would be
        aimed far past its target and the shape would suffer, or the same weights as another (no affine maps). Where one
        cannot arrive (to 1e-6 of the targets' extent) all are taken as far as they go by effective targets that move
        continuously with the targets: those of the mean of the rotations that fit nearly as well as the best at a
        control point. What `neuralmls deform` and the browser editor do.

        Parameters
        ----------
        targets, temperature, adherence, rotations, scales
            As `aim` has them.

        Raises
        ------
        ArgumentError
            As `aim`.
        """
        checked = self._checked(targets, temperature, rotations, scales)
        aimed, misses, soft = self._core.aim(*checked, as_adherence(adherence, len(self._p)), True)
        return Aim(aimed, misses, None if soft is None else Soft(*soft))  # type: ignore[arg-type]

    def remedy(
        self,
        targets: ArrayLike,
        temperature: float = 1.0,
        adherence: ArrayLike = 1.0,
        *,
        rotations: Rotations = None,
        scales: Scales = None,
    ) -> str | None:
        """Return with what the control points would arrive, in words; None where nothing that was tried helps.

        Half the temperature is tried, and then the affine transform.

        Parameters
        ----------
        targets, temperature, adherence, rotations, scales
            As `aim` has them.

        Raises
        ------
        ArgumentError
            As `aim`.
        """
        checked = self._checked(targets, temperature, rotations, scales)
        return self._core.remedy(*checked, as_adherence(adherence, len(self._p)))

    def _checked(
        self, targets: ArrayLike, temperature: float, rotations: Rotations, scales: Scales
    ) -> tuple[Array, Array | None, float]:
        q = as_points("targets", targets, self._p.shape[1])
        if len(q) != len(self._p):
            raise ArgumentError(f"targets: expected {len(self._p)} of them, found {len(q)}")
        return q, as_orientations(rotations, scales, *q.shape), as_number("temperature", temperature, 0)


def as_adherence(value: ArrayLike, count: int) -> list[float]:
    """Return one number for all control points, or one for each.

    Raises
    ------
    ArgumentError
        It is none from 0 to 1, or there are not so many.
    """
    if np.ndim(value) == 0:
        return [as_number("adherence", value, 0, 1, open_low=False)]  # type: ignore[arg-type]
    listed = [as_number("adherence", one, 0, 1, open_low=False) for one in np.ravel(value)]
    if len(listed) != count:
        raise ArgumentError(f"adherence: expected one number, or {count} of them, found {len(listed)}")
    return listed


def _restored(weights: Weights | HasLogits, transform: Transform) -> ExactHandles:
    return ExactHandles(weights, transform=transform)
