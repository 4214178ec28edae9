"""Where a deformation of space folds it over."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import ArrayLike

from neuralmls.errors import ArgumentError
from neuralmls.plugin import as_number, as_points
from neuralmls_research.metrics.triangles import Array


def folded_places(f: Callable[[Array], Array], x: ArrayLike, *, step: float) -> int:
    """Count the places where a map of space turns it inside out: `det(Jacobian of f) <= 0`.

    The Jacobian is the true one of the map, by central differences, not only the local map `M` of moving least
    squares, which leaves out how the weights change.

    Parameters
    ----------
    f : callable, (n, d) -> (n, d)
    x : (n, d), where to look
    step : float > 0, in units of `x`
        Half of the distance between two points that are compared.

    Raises
    ------
    ArgumentError
        `x` does not hold finite points, the step is not above 0, or `f` gives something else.

    Examples
    --------
    >>> folded_places(lambda x: np.abs(x), [[1.0], [-1.0]], step=1e-3)
    1
    """
    points = as_points("x", x)
    h = as_number("step", step, 0)
    values = [as_points("f(x)", f(place), points.shape[1]) for place in beside(points, h)]
    if len(values[0]) != len(points):
        raise ArgumentError(f"f(x): expected {len(points)} points, found {len(values[0])}")
    return int((np.linalg.det(jacobians(values, h)) <= 0).sum())


def beside(x: Array, step: float) -> list[Array]:
    """The points `step` up and down each axis from each of `x` (n, d), 2 d arrays: where `jacobians` wants values."""
    return [x + way * shift for shift in step * np.eye(x.shape[1]) for way in (1, -1)]


def jacobians(values: Sequence[Array], step: float) -> Array:
    """The Jacobians (n, d, d) of a map by central differences of its values at the points `beside` each point.

    Examples
    --------
    >>> double = [2 * x for x in beside(np.zeros((1, 2)), 0.1)]
    >>> jacobians(double, 0.1).round(9).tolist()
    [[[2.0, 0.0], [0.0, 2.0]]]
    """
    columns = [(up - down) / (2 * step) for up, down in zip(values[::2], values[1::2], strict=True)]
    return np.stack(columns, axis=2)
