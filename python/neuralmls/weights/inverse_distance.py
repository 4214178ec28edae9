"""The classic weights of moving least squares (Schaefer, McPhail, Warren 2006)."""

from __future__ import annotations

from numpy.typing import ArrayLike

from neuralmls import _core
from neuralmls.arrays import as_box
from neuralmls.settings import changes_of
from neuralmls.weights.function import Weights, as_control_points


class InverseDistanceWeights(Weights):
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

    _kind = "inverse-distance"

    def __init__(
        self,
        control_points: ArrayLike,
        *,
        alpha: float = 1.0,
        epsilon: float = 0.0,
        bounds: ArrayLike | None = None,
    ) -> None:
        p = as_control_points(control_points)
        box = None if bounds is None else as_box(bounds, p.shape[1])
        settings = changes_of(self._kind, {"alpha": alpha, "epsilon": epsilon})
        self._core = _core.Weights.fitted(p, box, None, settings, None)

    @property
    def alpha(self) -> float:
        """The exponent of the squared distance."""
        assert self._core.parameters is not None
        return self._core.parameters[0]

    @property
    def epsilon(self) -> float:
        """What caps the weight near a control point."""
        assert self._core.parameters is not None
        return self._core.parameters[1]
