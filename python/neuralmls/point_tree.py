"""The points of a shape in a spatial tree, which depends on them alone: built once, used by every fit."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from neuralmls import _core
from neuralmls.arrays import Progress, as_box, as_points, box_around
from neuralmls.errors import ArgumentError


class PointTree:
    """Points ordered for the evaluation of neural weights; takes the place of an array of points.

    `NeuralWeights.logits` builds such a tree each time that it is given an array. Where several networks are
    evaluated at the same points (control points are added or moved at rest), building it once saves that.

    Parameters
    ----------
    x : (n, d), d = 1, 2 or 3
        The points, in any units.
    bounds : (2, d), optional
        The shape's box, the same that the networks are fitted with; without it, the box of the points.
    progress : callable, optional
        Told the fraction done, from 0 to 1; what it raises stops the call.

    Raises
    ------
    ArgumentError
        `x` does not hold finite points, or all are in one place.

    Examples
    --------
    >>> from neuralmls import NeuralWeights
    >>> x = np.random.default_rng(0).uniform(-1, 1, (1000, 2))
    >>> tree = PointTree(x, bounds=[[-1, -1], [1, 1]])
    >>> weights = NeuralWeights.fit([[-1.0, 0.0], [1.0, 0.0]], bounds=tree.bounds, width=64)
    >>> bool(np.array_equal(weights.logits(tree), weights.logits(x)))
    True
    """

    def __init__(self, x: ArrayLike, *, bounds: ArrayLike | None = None, progress: Progress | None = None) -> None:
        self._points = as_points("x", x)
        if bounds is None and not len(self._points):
            raise ArgumentError("x: expected at least one point where no bounds are given")
        self._bounds = as_box(box_around(self._points) if bounds is None else bounds, self._points.shape[1])
        self._core = _core.PointTree(self._points, self._bounds, progress)

    @property
    def bounds(self) -> NDArray[np.float64]:
        """The box that the points are measured by, (2, d): give it to `NeuralWeights.fit`."""
        return self._bounds

    def __len__(self) -> int:
        return len(self._points)

    def __array__(self, dtype: DTypeLike | None = None, copy: bool | None = None) -> NDArray[Any]:
        """The points themselves, in their own order, so that the tree can stand where points are expected."""
        return np.array(self._points, dtype=dtype, copy=copy)
