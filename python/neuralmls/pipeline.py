"""The pipeline: control points -> fit -> logits -> softmax(T) -> MLS. The one place where its steps meet."""

from __future__ import annotations

from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from neuralmls.arrays import as_points
from neuralmls.deformer import Deformer, Floats
from neuralmls.errors import ArgumentError
from neuralmls.protocol import Transform
from neuralmls.turns import Rotations, Scales
from neuralmls.weights import InverseDistanceWeights, NeuralWeights, ShapeAwareWeights, Weights

WeightsName: TypeAlias = Literal["neural", "shape-aware", "inverse-distance"]


def deform(
    x: ArrayLike,
    p: ArrayLike,
    q: ArrayLike,
    *,
    rotations: Rotations = None,
    scales: Scales = None,
    weights: WeightsName | Weights = "neural",
    faces: ArrayLike | None = None,
    transform: Transform = "rigid",
    temperature: float = 1.0,
    exact: bool = False,
    seed: int = 0,
) -> Floats:
    """Deform the points `x` so that the control points `p` move to `q`, in one call.

    To move them again and again, bind once: `Deformer(x, NeuralWeights.fit(p, bounds=...)).deform(q)`.

    Parameters
    ----------
    x : (n, d), d = 1, 2 or 3
        Points: float32 or float64, of any memory layout; never changed.
    p, q : (m, d)
        Control points at rest and moved, in the coordinates of `x`.
    rotations : (m, d, d), scales : (m,), optional
        How control points turn, and how much larger their surroundings become; None for those that only move (see
        `Deformer.deform`).
    weights : "neural", "shape-aware", "inverse-distance", or a weight function of the control points `p`
    faces : (f, 3) integers, optional
        Triangles of the points, for shape-aware weights; without them the points are a cloud.
    transform : "rigid", "similarity" or "affine"
    temperature : float > 0
    exact : bool
        Whether the control points go all the way to their targets (see `ExactHandles`), not only near them.
    seed : int
        Of the network's training (neural and shape-aware weights).

    Returns
    -------
    (n, d), float32 if `x` was, else float64

    Raises
    ------
    ArgumentError
        An argument is out of its range, or does not fit another.
    NeuralMLSError
        Shape-aware weights need SciPy, and it is not installed.

    Examples
    --------
    >>> deform([[0.0], [1.0], [2.0]], [[0.0], [2.0]], [[1.0], [3.0]], weights="inverse-distance").tolist()
    [[1.0], [2.0], [3.0]]
    """
    sources = as_points("p", p)
    targets = as_points("q", q, sources.shape[1])
    if len(sources) == 0 or len(targets) != len(sources):
        raise ArgumentError(
            f"q: expected one target for each of at least one control point, found {len(targets)} for {len(sources)}"
        )
    points = as_points("x", x, sources.shape[1])
    function: Weights
    if isinstance(weights, str) and weights == "neural":
        function = NeuralWeights.fit(sources, bounds=_bounds(points), seed=seed)
    elif isinstance(weights, str) and weights == "shape-aware":
        function = ShapeAwareWeights.fit(sources, points, faces, seed=seed)
    elif isinstance(weights, str) and weights == "inverse-distance":
        function = InverseDistanceWeights(sources, bounds=_bounds(points))
    elif isinstance(weights, str) or not hasattr(weights, "control_points"):
        raise ArgumentError(
            f"weights: expected 'neural', 'shape-aware', 'inverse-distance' or a weight function, found {weights!r}"
        )
    else:
        function = weights
        if not np.array_equal(as_points("weights.control_points", function.control_points), sources):
            raise ArgumentError("weights: expected a weight function of the control points p, found one of others")
    deformer = Deformer(x, function, transform=transform)
    return deformer.deform(targets, temperature, rotations=rotations, scales=scales, adherence=float(bool(exact)))


def _bounds(points: np.ndarray[tuple[int, ...], np.dtype[np.float64]]) -> ArrayLike | None:
    """The points' box, or None where it has no size (the weights then measure by something else)."""
    if len(points) == 0 or (points == points[0]).all():
        return None
    return np.stack([points.min(axis=0), points.max(axis=0)])
