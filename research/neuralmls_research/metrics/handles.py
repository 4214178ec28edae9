"""Whether control points arrive: the paper's control-point error."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from neuralmls.errors import ArgumentError
from neuralmls.plugin import as_points
from neuralmls_research.metrics.triangles import Array


def handle_errors(x: ArrayLike, y: ArrayLike, p: ArrayLike, q: ArrayLike) -> Array:
    """Return how far each control point's nearest vertex ends from the control point's target, as the paper does.

    `|y_v - q_i|` with `v` the vertex nearest to `p_i` before. A control point that does not lie on a vertex keeps an
    error even if the map meets it exactly: for a map `f` of space measure `|f(p) - q|` too.

    Parameters
    ----------
    x, y : (n, d), the vertices before and after
    p, q : (m, d), the control points at rest and moved

    Returns
    -------
    (m,) float64, in the units of `x`

    Raises
    ------
    ArgumentError
        The arrays are no finite points, or do not fit each other.

    Source
    ------
    Shechter et al. 2022, section 4, figure 6.

    Examples
    --------
    >>> handle_errors([[0.0], [1.0]], [[0.0], [3.0]], [[0.9]], [[2.5]]).tolist()
    [0.5]
    """
    before = as_points("x", x)
    after, sources, targets = (
        as_points(name, values, before.shape[1]) for name, values in (("y", y), ("p", p), ("q", q))
    )
    if not len(before) or len(after) != len(before) or len(targets) != len(sources):
        raise ArgumentError(
            f"expected as many vertices after as before, at least one, and a target for each control point, "
            f"found {len(before)}, {len(after)}, {len(sources)}, {len(targets)}"
        )
    nearest = [int(((before - source) ** 2).sum(axis=1).argmin()) for source in sources]
    errors: Array = np.linalg.norm(after[nearest] - targets, axis=1)
    return errors
