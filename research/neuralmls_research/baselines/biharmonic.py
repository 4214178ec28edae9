"""Bounded biharmonic weights (Jacobson, Baran, Popovic, Sorkine 2011) by libigl, with the surface as their domain."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from neuralmls import Shape
from neuralmls.errors import NotApplicable
from neuralmls_research.baselines.checks import arguments, clean_mesh, finite, library, nearest_vertices, unit_of

METHOD = "biharmonic deformation"
ROUNDS = 8  # of the active set method, as in libigl's tutorial: the weights then leave [0, 1] by a few thousandths


def biharmonic(shape: Shape, p: ArrayLike, q: ArrayLike) -> NDArray[np.float64]:
    """Return `y = x + sum_i w_i (q_i - p_i)`, with weights `0 <= w_i <= 1` that minimise `sum_i 1/2 |Laplacian w_i|^2`.

    `w_i` is 1 at the vertex nearest to control point i and 0 at those of the others; each vertex's weights are divided
    by their sum. Control points have no rotation of their own, so that only translations are blended. The shape must be
    such a mesh as `arap` takes; it need not be closed: the paper fills it with tetrahedra, here the weights live on the
    surface. Arguments, result and further errors: `neuralmls_research.baselines`.

    Raises
    ------
    NotApplicable
        The shape is no such mesh; two control points have the same nearest vertex; there is no solution.

    Source
    ------
    Jacobson, Baran, Popovic, Sorkine, "Bounded Biharmonic Weights for Real-Time Deformation", SIGGRAPH 2011.

    Examples
    --------
    >>> import tempfile, pathlib, neuralmls as nm
    >>> path = pathlib.Path(tempfile.mkdtemp(), "triangle.obj")
    >>> _ = path.write_text("v 0 0 0\\nv 1 0 0\\nv 0 1 0\\nf 1 2 3\\n")
    >>> biharmonic(nm.read(path), [[0, 0, 0], [1, 0, 0]], [[0, 0, 0], [1, 0, 1]])[:2].round(6).tolist()
    [[0.0, 0.0, 0.0], [1.0, 0.0, 1.0]]
    """
    x, sources, targets = arguments(METHOD, shape, p, q)
    w = weights(shape, sources)
    if np.array_equal(sources, targets):
        return x.copy()
    y: NDArray[np.float64] = x + w @ (targets - sources)
    return y


def weights(shape: Shape, p: ArrayLike) -> NDArray[np.float64]:
    """Return the weights (n, m) alone, which depend on the control points at rest: for a shape that is moved often.

    Parameters and errors as for `biharmonic`.
    """
    x, sources, _ = arguments(METHOD, shape, p, p)
    igl = library("igl")
    held = nearest_vertices(METHOD, x, sources)
    faces = clean_mesh(METHOD, shape, held)
    centre, half = unit_of(x)
    try:
        raw = igl.bbw((x - centre) / half, faces, held, np.eye(len(held)), max_iter=ROUNDS)
    except RuntimeError as error:
        raise NotApplicable(f"{METHOD} cannot be solved on this mesh: libigl says '{error}'") from error
    w: NDArray[np.float64] = np.clip(finite(METHOD, raw), 0.0, 1.0)
    total = w.sum(axis=1, keepdims=True)
    if not (total > 0).all():
        raise NotApplicable(f"{METHOD} finds no weights for a vertex: the mesh is too badly conditioned for it")
    w /= total
    return w
