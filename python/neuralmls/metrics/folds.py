"""Where a deformation of space folds it over."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from neuralmls.arrays import as_number, as_points
from neuralmls.errors import ArgumentError
from neuralmls.metrics.triangles import Array


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
    columns = []
    for axis in range(points.shape[1]):
        shift = np.zeros(points.shape[1])
        shift[axis] = h
        ends = [as_points("f(x)", f(points + way * shift), points.shape[1]) for way in (1, -1)]
        if len(ends[0]) != len(points):
            raise ArgumentError(f"f(x): expected {len(points)} points, found {len(ends[0])}")
        columns.append((ends[0] - ends[1]) / (2 * h))
    return int((np.linalg.det(np.stack(columns, axis=2)) <= 0).sum())
