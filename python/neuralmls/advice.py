"""Advice about weights and targets that are not (yet) a session; `Map.advise` has it of a session."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from neuralmls import _core
from neuralmls.arrays import as_points
from neuralmls.control_points import ControlPoints
from neuralmls.errors import ArgumentError
from neuralmls.orientations import Orientation, Rotations, Scales, as_orientations
from neuralmls.report import Advice
from neuralmls.session import Map, Session
from neuralmls.settings import Handles, Transform
from neuralmls.weights import Weights


def advise(
    x: ArrayLike,
    faces: ArrayLike | None,
    weights: Weights,
    targets: ArrayLike,
    *,
    transform: Transform = "rigid",
    temperature: float = 1.0,
    handles: Handles = "soft",
    rotations: Rotations = None,
    scales: Scales = None,
    names: Sequence[str] | None = None,
) -> list[Advice]:
    """Return what is likely bad about a deformation, and what would help (see `Map.advise`).

    Parameters
    ----------
    x : (n, d)
        The shape's points at rest, in any units.
    faces : (f, 3) integers, or None for a point cloud
        With them places are looked at by area, otherwise the points themselves.
    weights : Weights
        The weight function of the control points, in the units of `x`.
    targets : (m, d)
    transform, temperature, handles
        As `Session` has them.
    rotations, scales
        As `Deformer.deform` has them.
    names : sequence of m str, optional
        What to call the control points; p1, p2, ... if not given.

    Raises
    ------
    ArgumentError
        There are no points, or an argument does not fit another.

    Examples
    --------
    >>> import numpy as np
    >>> from neuralmls import InverseDistanceWeights
    >>> x = np.linspace(0, 1, 21)[:, None]
    >>> weights = InverseDistanceWeights([[0.0], [0.4], [0.6], [1.0]])
    >>> advise(x, None, weights, weights.control_points + 1)
    []
    >>> [advice.kind for advice in advise(x, None, weights, [[0.0], [0.7], [0.3], [1.0]])]
    ['folds']
    """
    return fitted(
        weights,
        targets,
        transform=transform,
        temperature=temperature,
        handles=handles,
        rotations=rotations,
        scales=scales,
        names=names,
    ).advise(x, faces)


def fitted(
    weights: Weights,
    targets: ArrayLike,
    *,
    transform: Transform,
    temperature: float,
    handles: Handles,
    relax: float = 0.0,
    no_folds: bool = False,
    rotations: Rotations = None,
    scales: Scales = None,
    names: Sequence[str] | None = None,
    shape: tuple[NDArray[np.float64], NDArray[np.uint32]] | None = None,
    seed: int | None = None,
) -> Map:
    """Return the map of weights that were fitted already, as `advise` has its parameters.

    `shape`: for `relax` and `no_folds`; `seed`: of the networks of further steps.
    """
    p = weights.control_points
    q = as_points("targets", targets, p.shape[1])
    if len(q) != len(p):
        raise ArgumentError(f"targets: expected {len(p)} of them, found {len(q)}")
    if names is not None and len(names) != len(p):
        raise ArgumentError(f"names: expected {len(p)} of them, found {len(names)}")
    points = ControlPoints(p, q, names, orientations(rotations, scales, *p.shape))
    kind = weights._kind
    session = Session(
        points,
        weights=kind,  # type: ignore[arg-type]
        transform=transform,
        temperature=temperature,
        handles=handles,
        relax=relax,
        no_folds=no_folds,
    )
    if seed is not None:
        session = session.replace(seed=seed)
    return Map._of(_core.Map.of(session._core, weights._core, shape))


def orientations(rotations: Rotations, scales: Scales, count: int, dimension: int) -> list[Orientation | None] | None:
    """Return scaled rotation matrices, as `Deformer.deform` has them, as what control points carry."""
    scaled = as_orientations(rotations, scales, count, dimension)
    if scaled is None:
        return None
    oriented: list[Orientation | None] = [None] * count
    for i in np.flatnonzero(~np.isnan(scaled[:, 0, 0])):
        size = abs(np.linalg.det(scaled[i])) ** (1 / dimension)
        oriented[i] = Orientation.of(np.ascontiguousarray(scaled[i] / size), size)
    return oriented
