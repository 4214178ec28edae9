"""Maps of space the other way: from where points came, and how the map changes from place to place."""

from __future__ import annotations

from typing import Any, Literal, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from neuralmls import _core
from neuralmls.arrays import Progress, as_points, as_rows, dtype_of
from neuralmls.deformer import Floats
from neuralmls.shape import Shape


class Space:
    """What a map knows besides where points go: the inverse and the Jacobian. The base of `Map`."""

    _core: _core.Map

    def jacobian(self, points: ArrayLike, *, progress: Progress | None = None) -> NDArray[np.float64]:
        """Return the Jacobian `J = dy/dx` of the whole map at points.

        `J = M (I - Dp*) + Dq* + sum_k (dM/dx_k)(x - p*) e_k^T`: unlike the local maps `M` of `deform`, it has in it how
        the weights change. Where `det J <= 0` space is turned inside out. It is analytic; of neural weights as exact as
        their logits, which are float32. On a control point of inverse-distance weights with `2 alpha <= T`, and at the
        kinks of a network, there is no derivative: there it is a mean over directions, or that of one side.

        Parameters
        ----------
        points : (n, d), or a grid (..., d)
        progress : callable, optional
            Told the fraction done, from 0 to 1; what it raises stops the call.

        Returns
        -------
        (n, d, d) or (..., d, d) float64

        Raises
        ------
        ArgumentError
            They are no finite points of the map's dimension; the session has `relax` above 0.

        Examples
        --------
        >>> from neuralmls import ControlPoints, Session
        >>> points = ControlPoints([[0.0, 0], [1, 0]], targets=[[0.0, 0], [0, 1]])
        >>> map = Session(points, weights="inverse-distance").fit()
        >>> map.jacobian([[0.3, 0.0]]).round(6).tolist()                      # a quarter turn
        [[[0.0, -1.0], [1.0, 0.0]]]
        """
        rows, grid = as_rows(points)
        x = as_points("points", rows, self._core.session.points.sources.shape[1])
        jacobians = self._core.jacobian(x, progress)
        return jacobians if grid is None else jacobians.reshape(*grid, *jacobians.shape[1:])

    @overload
    def inverse(
        self,
        points: Shape | ArrayLike,
        *,
        return_found: Literal[False] = ...,
        return_maps: Literal[False] = ...,
        progress: Progress | None = ...,
    ) -> Floats: ...

    @overload
    def inverse(
        self,
        points: Shape | ArrayLike,
        *,
        return_found: bool = ...,
        return_maps: bool = ...,
        progress: Progress | None = ...,
    ) -> Any: ...

    def inverse(
        self,
        points: Shape | ArrayLike,
        *,
        return_found: bool = False,
        return_maps: bool = False,
        progress: Progress | None = None,
    ) -> Any:
        """Return from where points came: `x` with `map.at(x) = points` and `det J(x) > 0`.

        By Newton's method with halved steps, `x <- x - t J(x)^-1 (f(x) - y)`, from those samples of the map that go
        nearest to `y`. Exact to rounding with inverse-distance weights, but for the float32 logits of `at` itself; to
        about 1e-7 of the box with neural ones. Where several places go to a point, it is one of them.

        Parameters
        ----------
        points : Shape, points (n, d), or a grid (..., d)
        return_found : bool
            Also return for which points a place was found, a mask (n,) or (...); nothing is refused then, and the
            others get the place that goes nearest to them of those that were tried.
        return_maps : bool
            Also return the local maps back, `M^-1`, (n, d, d) float64, by which normals turn (`Shape.write`).
        progress : callable, optional
            Told the fraction done, from 0 to 1; what it raises stops the call.

        Returns
        -------
        Their shape, float32 if the points were, else float64; what else was asked for after it, in a tuple

        Raises
        ------
        ArgumentError
            They are no finite points of the map's dimension; for some of them no place was found, as where the map
            folds: how many, and the first of them; the session has `relax` above 0.

        Examples
        --------
        >>> from neuralmls import ControlPoints, Session
        >>> points = ControlPoints([[0.0, 0], [1, 0]], targets=[[0.0, 0], [0, 1]])
        >>> map = Session(points, weights="inverse-distance").fit()
        >>> map.inverse([[0.0, 0.5]]).round(6).tolist()
        [[0.5, 0.0]]
        """
        rows, grid = as_rows(points.positions if isinstance(points, Shape) else points)
        y = as_points("points", rows, self._core.session.points.sources.shape[1])
        positions, maps, missed = self._core.inverse(y, return_found, return_maps, progress)
        x = positions.astype(dtype_of(rows), copy=False)
        found = np.ones(len(y), bool)
        found[missed] = False
        if grid is not None:
            x, found = x.reshape(*grid, -1), found.reshape(grid)
            maps = None if maps is None else maps.reshape(*grid, *maps.shape[1:])
        more = [*([found] if return_found else []), *([maps] if return_maps else [])]
        return (x, *more) if more else x
