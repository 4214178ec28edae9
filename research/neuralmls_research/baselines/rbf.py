"""Interpolation of the displacements by radial basis functions (SciPy): the thin plate of three dimensions."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from neuralmls import Shape
from neuralmls.errors import NotApplicable
from neuralmls_research.baselines.checks import arguments, finite, library, unit_of

# Control points whose spread in one direction is less than this of that in another are taken for a plane: a linear term
# fitted across it would throw what is not in the plane a hundred times as far as the control points go.
FLAT = 0.01


def rbf(shape: Shape, p: ArrayLike, q: ArrayLike) -> NDArray[np.float64]:
    """Return `y = x + sum_i c_i |x - p_i| + A x + b`, the smoothest displacement that takes each `p_i` to its `q_i`.

    The kernel `|r|` minimises in space what the thin plate's `r^2 log r` does in the plane: the integral of all second
    derivatives squared. Where the control points span no volume (fewer than four, or about in a plane), `A` is zero.
    The faces are not looked at. Arguments, result and further errors: `neuralmls_research.baselines`.

    Raises
    ------
    NotApplicable
        Two control points are in the same place, or so close that the equations have no solution.

    Source
    ------
    Duchon, "Splines minimizing rotation-invariant semi-norms in Sobolev spaces", 1977; `scipy.interpolate`.

    Examples
    --------
    >>> import tempfile, pathlib, neuralmls as nm
    >>> path = pathlib.Path(tempfile.mkdtemp(), "three.xyz")
    >>> _ = path.write_text("0 0 0\\n0.5 0 0\\n1 0 0\\n")
    >>> rbf(nm.read(path), [[0, 0, 0], [1, 0, 0]], [[0, 0, 0], [1, 1, 0]]).round(6).tolist()
    [[0.0, 0.0, 0.0], [0.5, 0.5, 0.0], [1.0, 1.0, 0.0]]
    """
    x, sources, targets = arguments("RBF", shape, p, q)
    if len(np.unique(sources, axis=0)) < len(sources):
        raise NotApplicable("RBF needs control points in different places, and two are in the same")
    if np.array_equal(sources, targets):
        return x.copy()
    centre, half = unit_of(np.concatenate([x, sources]))
    p_unit = (sources - centre) / half
    spread = np.linalg.svd(p_unit - p_unit.mean(axis=0), compute_uv=False)
    fills_space = len(spread) == 3 and spread[2] > FLAT * spread[0] and len(sources) >= 4
    interpolate = library("scipy.interpolate").RBFInterpolator
    try:
        moved = interpolate(p_unit, (targets - sources) / half, kernel="linear", degree=1 if fills_space else 0)
    except np.linalg.LinAlgError as error:
        raise NotApplicable(f"RBF has no solution, two control points are too close to each other: {error}") from error
    return finite("RBF", x + half * np.asarray(moved((x - centre) / half)))
