"""The classic weights of moving least squares (Schaefer, McPhail, Warren 2006)."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from neuralmls import _core
from neuralmls.arrays import Progress, as_box, as_number, as_points, box_around


class InverseDistanceWeights:
    """The classic weights `w_i = 1 / (d_i^(2 alpha) + epsilon)`, normalised, as logits `-log(d_i^(2 alpha) + epsilon)`.

    Parameters
    ----------
    control_points : (m, d), d = 1, 2 or 3
        The control points at rest, `p`.
    alpha : float > 0
        Exponent of the *squared* distance: 0.5 is 1/d.
    epsilon : float >= 0
        Caps the weight near a control point, which then is no longer met exactly. Distances count in halves of the
        longest side of `bounds`, so that the same epsilon means the same for a shape of any size, here and in the
        command line.
    bounds : (2, d), optional
        The shape's box; the control points' own if not given.

    Raises
    ------
    ArgumentError
        A number is out of its range, or the control points are not finite points.

    Examples
    --------
    >>> from neuralmls import softmax
    >>> weights = InverseDistanceWeights([[0.0, 0.0], [1.0, 0.0]], alpha=0.5)
    >>> softmax(weights.logits([[0.25, 0.0]])).round(4).tolist()
    [[0.75, 0.25]]
    """

    def __init__(
        self,
        control_points: ArrayLike,
        *,
        alpha: float = 1.0,
        epsilon: float = 0.0,
        bounds: ArrayLike | None = None,
    ) -> None:
        self._p = as_points("control_points", control_points).copy()
        self._p.flags.writeable = False
        self.alpha = as_number("alpha", alpha, 0)
        self.epsilon = as_number("epsilon", epsilon, 0, open_low=False)
        self._half = (box_around(self._p) if bounds is None else as_box(bounds, self._p.shape[1]))[1]
        self.logits(self._p[:0])  # refuses what the core refuses now, not at the first use

    @property
    def control_points(self) -> NDArray[np.float64]:
        """The control points at rest, (m, d)."""
        return self._p

    def logits(self, x: ArrayLike, *, progress: Progress | None = None) -> NDArray[np.float32]:
        """Return the logits of the points `x` (n, d): (n, m); +infinity on a control point if epsilon is 0.

        Raises
        ------
        ArgumentError
            `x` does not hold finite points of the control points' dimension.
        """
        points = as_points("x", x, self._p.shape[1])
        return _core.inverse_distance_logits(points, self._p, self._half, self.alpha, self.epsilon, progress)
