"""All measures of one deformation."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from neuralmls.plugin import as_points, box_around
from neuralmls_research.metrics.curvature import Change, curvature_change
from neuralmls_research.metrics.flips import Flips, flipped_triangles
from neuralmls_research.metrics.folds import folded_places
from neuralmls_research.metrics.handles import handle_errors
from neuralmls_research.metrics.strains import Strain, strain
from neuralmls_research.metrics.triangles import Array
from neuralmls_research.metrics.volumes import volume_change

# Of the Jacobian's differences, in halves of the box's longest side: far above the rounding of single-precision
# logits (1e-7), far below what a deformation does.
STEP = 1e-3


@dataclass(frozen=True)
class Measures:
    """What a deformation does; lengths in halves of the longest side of the box of the shape at rest.

    Attributes
    ----------
    at_vertices : float
        Mean distance of control points to targets, at the nearest vertex (the paper's).
    at_points : float or None
        At the control points themselves; None where the deformation is no map of space.
    curvature, laplacian : Change or None
        The paper's distortion; like all that follows, None without faces.
    strain : Strain or None
    flips : Flips or None
    volume : float or None
        By which part the volume changes; None also where the surface is not closed.
    folded : int or None
        Vertices where the map turns space inside out; None where the deformation is no map of space.
    """

    at_vertices: float
    at_points: float | None
    curvature: Change | None
    laplacian: Change | None
    strain: Strain | None
    flips: Flips | None
    volume: float | None
    folded: int | None


def measure(
    x: ArrayLike,
    y: ArrayLike,
    faces: ArrayLike | None,
    p: ArrayLike,
    q: ArrayLike,
    *,
    f: Callable[[Array], Array] | None = None,
) -> Measures:
    """Measure a deformation from `x` to `y`, by everything that this package measures.

    Parameters
    ----------
    x, y : (n, d), the vertices before and after, in any units: they are divided by half of the longest side of the
        box of `x`
    faces : (f, 3) integers, or None for a point cloud
    p, q : (m, d), the control points at rest and moved, in the units of `x`
    f : callable, optional
        The map of space (n, d) -> (n, d) of which `y` is what it makes of `x`, in the units of `x`.

    Raises
    ------
    ArgumentError
        The arrays are no such arrays, or do not fit each other.

    Examples
    --------
    >>> square = np.array([[0.0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0]])
    >>> found = measure(square, square + 1, [[0, 1, 2], [0, 2, 3]], square[:1], square[:1] + [[1, 1, 2]])
    >>> found.at_vertices, found.strain.dirichlet_mean, found.flips.count, found.volume
    (1.0, 4.0, 0, None)
    """
    before = as_points("x", x)
    after, sources, targets = (
        as_points(name, values, before.shape[1]) for name, values in (("y", y), ("p", p), ("q", q))
    )
    low, high = box_around(before)
    centre, half = low + (high - low) / 2, float((high - low).max()) / 2 or 1.0
    errors = handle_errors(before, after, sources, targets) / half
    at_points = None if f is None else float(np.linalg.norm(f(sources) - targets, axis=1).mean() / half)
    folded = None if f is None else folded_places(f, before, step=STEP * half)
    if faces is None or before.shape[1] != 3:
        return Measures(float(errors.mean()), at_points, None, None, None, None, None, folded)
    old, new = (before - centre) / half, (after - centre) / half
    curvature, laplacian = curvature_change(old, new, faces)
    return Measures(
        at_vertices=float(errors.mean()),
        at_points=at_points,
        curvature=curvature,
        laplacian=laplacian,
        strain=strain(old, new, faces),
        flips=flipped_triangles(old, new, faces),
        volume=volume_change(old, new, faces),
        folded=folded,
    )
