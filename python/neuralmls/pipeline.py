"""The whole way in one call: points, control points, targets -> positions."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from neuralmls.advice import fitted, orientations
from neuralmls.arrays import as_points, box_around
from neuralmls.control_points import ControlPoints
from neuralmls.deformer import Deformer, Floats
from neuralmls.errors import ArgumentError
from neuralmls.handles import ExactHandles
from neuralmls.orientations import Rotations, Scales
from neuralmls.placement import as_indices
from neuralmls.session import Session
from neuralmls.settings import Handles, Transform, WeightsName
from neuralmls.weights import HasLogits, InverseDistanceWeights, NeuralWeights, ShapeAwareWeights, Weights


def deform(
    x: ArrayLike,
    p: ArrayLike,
    q: ArrayLike,
    *,
    rotations: Rotations = None,
    scales: Scales = None,
    weights: WeightsName | Weights | HasLogits = "neural",
    faces: ArrayLike | None = None,
    transform: Transform = "rigid",
    temperature: float = 1.0,
    handles: Handles = "auto",
    relax: float = 0.0,
    no_folds: bool = False,
    seed: int = 0,
) -> Floats:
    """Deform the points `x` so that the control points `p` move to `q`: what `neuralmls deform` does, in one call.

    To move them again and again, fit once: `Session(ControlPoints(p)).fit(x)`, or bind once: `Deformer`.

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
        Triangles of the points, for shape-aware weights, `relax` and `no_folds`; without them the points are a cloud.
    transform : "rigid", "similarity" or "affine"
    temperature : float > 0
    handles : "auto", "exact", "soft", or a number from 0 to 1
        How closely the control points arrive at their targets (see `Session`). "soft" is the paper's way, in which
        they stop near them.
    relax : float, 0 to 1
        How far the elastic finish goes (see `Session`); above 0 for weights of this package only.
    no_folds : bool
        Whether nothing of the shape is to fold over (see `Session`); for neural and inverse-distance weights.
    seed : int
        Of the network's training (neural and shape-aware weights).

    Returns
    -------
    (n, d), float32 if `x` was, else float64

    Raises
    ------
    ArgumentError
        An argument is out of its range, or does not fit another.

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
    box = box_around(points) if len(points) and (points != points[0]).any() else None
    function: Weights | HasLogits
    if isinstance(weights, str) and weights == "neural":
        function = NeuralWeights.fit(sources, bounds=box, seed=seed)
    elif isinstance(weights, str) and weights == "shape-aware":
        function = ShapeAwareWeights.fit(sources, points, faces, seed=seed)
    elif isinstance(weights, str) and weights == "inverse-distance":
        function = InverseDistanceWeights(sources, bounds=box)
    elif isinstance(weights, str) or not hasattr(weights, "control_points"):
        raise ArgumentError(
            f"weights: expected 'neural', 'shape-aware', 'inverse-distance' or a weight function, found {weights!r}"
        )
    else:
        function = weights
        if not np.array_equal(as_points("weights.control_points", function.control_points), sources):
            raise ArgumentError("weights: expected a weight function of the control points p, found one of others")
    if isinstance(function, Weights):
        map = fitted(
            function,
            targets,
            transform=transform,
            temperature=temperature,
            handles=handles,
            relax=relax,
            no_folds=no_folds,
            rotations=rotations,
            scales=scales,
            shape=(points, as_indices(faces, len(points))),
            seed=seed if isinstance(function, NeuralWeights) else None,
        )
        return map.at(x)
    # Logits of someone's own: the same steps, of which a map would keep the weights.
    posed = ControlPoints(sources, targets, orientations=orientations(rotations, scales, *sources.shape))
    session = Session(posed, transform=transform, temperature=temperature, handles=handles, relax=relax)
    if relax:
        raise ArgumentError("relax: expected weights of this package, found logits of another")
    if no_folds:
        raise ArgumentError("no_folds: expected weights of this package, found logits of another")
    aimed = session._core.aim(ExactHandles(function, transform=transform)._core)
    deformer = Deformer(x, function, transform=transform)
    return deformer.deform(aimed, temperature, rotations=posed.rotations, scales=posed.scales)
