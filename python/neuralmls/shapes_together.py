"""Several shapes as one: what a map of all of them is fitted to."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from neuralmls.arrays import as_points, box_around
from neuralmls.errors import ArgumentError
from neuralmls.placement import as_indices
from neuralmls.shape import Shape


def box_of(shape: Shape | ArrayLike, dimension: int) -> NDArray[np.float64]:
    """Return the box of a shape, (2, d).

    Raises
    ------
    ArgumentError
        There are no points, or they are of another dimension.
    """
    if isinstance(shape, Shape):
        return as_points("shapes", shape.bounds, dimension)
    x = as_points("shapes", shape, dimension)
    if not len(x):
        raise ArgumentError("shapes: expected at least one point, found none")
    return box_around(x)


def together(shapes: Iterable[Shape | ArrayLike], dimension: int) -> tuple[NDArray[np.float64], NDArray[np.uint32]]:
    """The points and triangles (none of clouds) of several shapes as those of one, as the core takes them."""
    points, triangles, count = [], [], 0
    for shape in shapes:
        x = shape.positions if isinstance(shape, Shape) else as_points("shapes", shape, dimension)
        if isinstance(shape, Shape) and shape.faces is not None:
            triangles.append(as_indices(shape.faces, len(x)) + np.uint32(count))
        points.append(x)
        count += len(x)
    return np.concatenate(points), np.concatenate([np.empty((0, 3), dtype=np.uint32), *triangles])
