"""Points bound to their weights once, and deformed many times."""

from __future__ import annotations

from functools import cached_property
from typing import Any, Literal, Self, TypeAlias, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from neuralmls import _core
from neuralmls.arrays import Progress, as_number, as_points, dtype_of
from neuralmls.errors import ArgumentError
from neuralmls.handles import ExactHandles
from neuralmls.orientations import Rotations, Scales, as_orientations
from neuralmls.point_tree import PointTree
from neuralmls.settings import Transform
from neuralmls.weights import HasLogits, Weights

Floats: TypeAlias = NDArray[np.floating]


class Deformer:
    """Points `x`, bound to the logits of a weight function, deformed by moving least squares.

    `y = M (x - p*) + q*`, with the weighted centroids `p* = sum w_i p_i` and `q* = sum w_i q_i`, and `M` the rotation,
    rotation and scale, or linear map that minimises `sum w_i |M (p_i - p*) - (q_i - q*)|^2`. A rigid `M` is never a
    reflection; what few or aligned control points leave open follows the motion of all of them.

    Parameters
    ----------
    x : (n, d), d = 1, 2 or 3
        The points, in any units; or a `PointTree` of them, which saves time where several networks are bound to them.
    weights : Weights
        `NeuralWeights`, `InverseDistanceWeights`, or anything with `control_points` and `logits`.
    transform : "rigid", "similarity" or "affine"
    progress : callable, optional
        Told the fraction done of the evaluation of the weights; what it raises stops it.

    Raises
    ------
    ArgumentError
        `x` does not hold finite points of the control points' dimension, or there is no such transform or weight
        function.

    Source
    ------
    Schaefer, McPhail, Warren 2006; Zhu, Gortler 2007; Shechter et al. 2022, section 3.

    Examples
    --------
    >>> from neuralmls import InverseDistanceWeights
    >>> weights = InverseDistanceWeights([[0.0, 0.0], [1.0, 0.0]])
    >>> deformer = Deformer([[0.5, 0.5]], weights, transform="rigid")
    >>> deformer.deform([[0.0, 0.0], [0.0, 1.0]]).round(6).tolist()   # a quarter turn
    [[-0.5, 0.5]]
    """

    def __init__(
        self,
        x: ArrayLike,
        weights: Weights | HasLogits,
        *,
        transform: Transform = "rigid",
        progress: Progress | None = None,
    ) -> None:
        self._dtype = dtype_of(x)
        if not hasattr(weights, "control_points"):
            raise ArgumentError(
                f"weights: expected a weight function, with control_points and logits, found {weights!r}"
            )
        if not isinstance(transform, str):
            raise ArgumentError(f"transform: expected rigid or similarity or affine, found {transform!r}")
        p = as_points("control_points", weights.control_points)
        points = as_points("x", x, p.shape[1])
        self._weights, self._transform = weights, transform
        self._p = p
        self._count = len(points)
        if isinstance(weights, Weights):
            tree = x._core if isinstance(x, PointTree) else None
            self._core = _core.Deformer(points, weights._core, tree, transform, progress)
            return
        logits = np.ascontiguousarray(weights.logits(points, progress=progress), dtype=np.float32)
        if logits.shape != (len(points), len(p)):
            raise ArgumentError(f"logits: expected shape {(len(points), len(p))}, found {logits.shape}")
        self._core = _core.Deformer.of_logits(points, p, logits, transform)

    @classmethod
    def _of_map(
        cls, x: ArrayLike, map: _core.Map, weights: Weights, transform: Transform, progress: Progress | None
    ) -> Self:
        """Points bound by a map, and to its elastic shape if it has one."""
        self = cls.__new__(cls)
        self._p, self._weights, self._transform, self._dtype = weights.control_points, weights, transform, dtype_of(x)
        points = as_points("x", x, self._p.shape[1])
        self._count = len(points)
        self._core = map.bind(points, x._core if isinstance(x, PointTree) else None, progress)
        return self

    def __reduce__(self) -> tuple[Any, ...]:
        state = (self._core.points, self._p, self._core.logits, self._transform, self._dtype.str, self._weights)
        return _restored, state

    @cached_property
    def _handles(self) -> ExactHandles:
        return ExactHandles(self._weights, transform=self._transform)

    def prepare(self, temperature: float = 1.0) -> None:
        """Compute the weights `softmax(logits / T)` now, so that the first frame at T takes no longer than the next.

        Parameters
        ----------
        temperature : float > 0
            `T`, of the frames that follow.

        Raises
        ------
        ArgumentError
            The temperature is not above 0.

        Examples
        --------
        >>> from neuralmls import InverseDistanceWeights
        >>> deformer = Deformer([[0.5, 0.5, 0.0]], InverseDistanceWeights([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]]))
        >>> deformer.prepare()
        >>> deformer.deform([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]]).tolist()
        [[0.5, 0.5, 0.0]]
        """
        self._core.prepare(as_number("temperature", temperature, 0))

    @overload
    def deform(
        self,
        targets: ArrayLike,
        temperature: float = ...,
        *,
        rotations: Rotations = ...,
        scales: Scales = ...,
        adherence: ArrayLike = ...,
        return_maps: Literal[False] = ...,
        out: NDArray[np.float64] | None = ...,
        progress: Progress | None = ...,
    ) -> Floats: ...

    @overload
    def deform(
        self,
        targets: ArrayLike,
        temperature: float = ...,
        *,
        rotations: Rotations = ...,
        scales: Scales = ...,
        adherence: ArrayLike = ...,
        return_maps: Literal[True],
        out: NDArray[np.float64] | None = ...,
        progress: Progress | None = ...,
    ) -> tuple[Floats, NDArray[np.float64]]: ...

    def deform(
        self,
        targets: ArrayLike,
        temperature: float = 1.0,
        *,
        rotations: Rotations = None,
        scales: Scales = None,
        adherence: ArrayLike = 0.0,
        return_maps: bool = False,
        out: NDArray[np.float64] | None = None,
        progress: Progress | None = None,
    ) -> Floats | tuple[Floats, NDArray[np.float64]]:
        """Return where the points go when the control points go to `targets`.

        Parameters
        ----------
        targets : (m, d)
            The control points moved, `q`. If all are where and as they were, the points are returned bit for bit.
        temperature : float > 0
            Of the softmax: below 1 parts move more apart from each other, above 1 more together.
        rotations : (m, d, d), optional
            How control points turn: for each a rotation matrix, or None (or NaN) for one that only goes to its target
            and does not resist turning. What is near a turned control point turns with it.
        scales : (m,), optional
            How much larger the surroundings of control points become, above 0, or None (or NaN); a control point with a
            scale and no rotation is held unturned. Rigid deformations leave scales away.
        adherence : float, 0 to 1, or (m,)
            0: plain moving least squares, which takes the control points near their targets; 1: they arrive, see
            `ExactHandles`.
        return_maps : bool
            Also return the local maps `M`, (n, d, d) float64.
        out : (n, d) C-contiguous float64, optional
            Where to write the result, which is then returned; for a drag, so that no frame asks for memory.
        progress : callable, optional
            Told the fraction done, from 0 to 1; what it raises stops the call.

        Returns
        -------
        (n, d), float32 if the points were, else float64

        Raises
        ------
        ArgumentError
            The targets, rotations or scales are not as many as there are control points; a target is not finite, a
            rotation is none (orthonormal columns, determinant 1), a scale is not above 0; the temperature is not above
            0; the adherence is not from 0 to 1.
        """
        q = as_points("targets", targets, self._p.shape[1])
        if len(q) != len(self._p):
            raise ArgumentError(f"targets: expected {len(self._p)} of them, found {len(q)}")
        t = as_number("temperature", temperature, 0)
        if out is not None and not (
            isinstance(out, np.ndarray)
            and out.shape == (self._count, q.shape[1])
            and out.dtype == np.float64
            and out.flags.c_contiguous
            and out.flags.writeable
        ):
            raise ArgumentError(f"out: expected a writeable C-contiguous float64 array {(self._count, q.shape[1])}")
        if np.any(np.not_equal(adherence, 0)):
            q = self._handles.aim(q, t, adherence, rotations=rotations, scales=scales).targets
        orientations = as_orientations(rotations, scales, *q.shape)
        positions, maps = self._core.deform(q, orientations, t, return_maps, out, progress)
        y: Floats = positions if out is not None else positions.astype(self._dtype, copy=False)
        return (y, maps) if maps is not None else y


def _restored(
    x: NDArray[np.float64],
    p: NDArray[np.float64],
    logits: NDArray[np.float32],
    transform: Transform,
    dtype: str,
    weights: Weights | HasLogits,
) -> Deformer:
    """The deformer of the same points, whose logits are not computed again."""
    deformer = Deformer.__new__(Deformer)
    deformer._core = _core.Deformer.of_logits(x, p, logits, transform)
    deformer._p, deformer._weights, deformer._transform = p, weights, transform
    deformer._count, deformer._dtype = len(x), np.dtype(dtype)
    return deformer
