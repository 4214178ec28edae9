"""As-rigid-as-possible deformation (Sorkine, Alexa 2007) by libigl, whose energy is that of spokes and rims."""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from neuralmls import Shape
from neuralmls.errors import NotApplicable
from neuralmls_research.baselines.checks import arguments, clean_mesh, finite, library, nearest_vertices, unit_of
from neuralmls_research.baselines.rigid import moved_rigidly

ITERATIONS = 50  # each fits a rotation to every vertex, and then the vertices to the rotations
# How far a vertex may still go in the last tenth of them, in longest sides of the shape: more is no convergence.
UNSETTLED = 0.1


def arap(shape: Shape, p: ArrayLike, q: ArrayLike, *, start: Literal["rest", "fit"] = "rest") -> NDArray[np.float64]:
    """Return the vertices `y` that minimise `sum_i sum_(j ~ i) c_ij |(y_i - y_j) - R_i (x_i - x_j)|^2`.

    `R_i` is a rotation, `c_ij` the cotangent weight. The vertex nearest to each control point is a constraint, as in
    the paper: it moves by `q - p`. The shape must be a manifold triangle mesh without degenerate triangles, with a
    control point on each connected part. Other arguments, result and further errors: `neuralmls_research.baselines`.

    Parameters
    ----------
    start : "rest" or "fit"
        Where the iterations begin, which decides where they end: from the rest positions, moved by the mean of what the
        control points move by; or from these turned, too, by the rotation that takes the control points nearest to
        their targets, which is better where the shape turns as a whole.

    Raises
    ------
    NotApplicable
        The shape is no such mesh; two control points have the same nearest vertex; the iterations do not settle.

    Source
    ------
    Sorkine, Alexa, "As-Rigid-As-Possible Surface Modeling", SGP 2007; Chao et al. 2010 for the energy. 50 iterations.

    Examples
    --------
    >>> import tempfile, pathlib, neuralmls as nm
    >>> path = pathlib.Path(tempfile.mkdtemp(), "triangle.obj")
    >>> _ = path.write_text("v 0 0 0\\nv 1 0 0\\nv 0 1 0\\nf 1 2 3\\n")
    >>> arap(nm.read(path), [[0, 0, 0]], [[0, 0, 1]]).round(6).tolist()
    [[0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, 1.0, 1.0]]
    """
    x, sources, targets = arguments("ARAP", shape, p, q)
    igl = library("igl")
    held = nearest_vertices("ARAP", x, sources)
    faces = clean_mesh("ARAP", shape, held)
    if np.array_equal(sources, targets):
        return x.copy()
    centre, half = unit_of(x)
    rest = (x - centre) / half
    data = igl.ARAPData()
    try:
        igl.arap_precomputation(rest, faces, 3, held.astype(np.int32), data)
        offsets = (targets - sources) / half
        constraints = rest[held] + offsets
        first = moved_rigidly(rest, rest[held], constraints) if start == "fit" else rest + offsets.mean(axis=0)
        data.max_iter = ITERATIONS - ITERATIONS // 10
        before = igl.arap_solve(constraints, data, first)
        data.max_iter = ITERATIONS // 10
        after: NDArray[np.float64] = finite("ARAP", igl.arap_solve(constraints, data, before))
    except RuntimeError as error:
        raise NotApplicable(f"ARAP cannot be solved on this mesh: libigl says '{error}'") from error
    last = float(np.abs(after - before).max()) / 2
    if last > UNSETTLED:
        raise NotApplicable(
            f"ARAP does not converge: the last {ITERATIONS // 10} of {ITERATIONS} iterations "
            f"still move a vertex by {last:.2g} of the shape's longest side"
        )
    return after * half + centre
