"""Biharmonic displacements (Botsch, Kobbelt 2004) by libigl: the smoothest field of displacements on the surface."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from neuralmls import Shape
from neuralmls.errors import NotApplicable
from neuralmls_research.baselines.checks import arguments, clean_mesh, finite, library, nearest_vertices, unit_of

METHOD = "biharmonic displacements"


def biharmonic_displacements(shape: Shape, p: ArrayLike, q: ArrayLike) -> NDArray[np.float64]:
    """Return `y = x + d`, with the displacements `d` that minimise `|Laplacian d|^2` over the surface.

    The vertex nearest to each control point moves by `q - p`. Nothing keeps rotations: linear, fast, and smooth at the
    handles as harmonic ones are not. The shape must be such a mesh as `arap` takes. Arguments, result and further
    errors: `neuralmls_research.baselines`.

    Raises
    ------
    NotApplicable
        The shape is no such mesh; two control points have the same nearest vertex; there is no solution.

    Source
    ------
    Botsch, Kobbelt, "An Intuitive Framework for Real-Time Freeform Modeling", SIGGRAPH 2004, with points as handles.

    Examples
    --------
    >>> import tempfile, pathlib, neuralmls as nm
    >>> path = pathlib.Path(tempfile.mkdtemp(), "triangle.obj")
    >>> _ = path.write_text("v 0 0 0\\nv 1 0 0\\nv 0 1 0\\nf 1 2 3\\n")
    >>> biharmonic_displacements(nm.read(path), [[0, 0, 0]], [[0, 0, 1]]).round(6).tolist()
    [[0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, 1.0, 1.0]]
    """
    x, sources, targets = arguments(METHOD, shape, p, q)
    igl = library("igl")
    held = nearest_vertices(METHOD, x, sources)
    faces = clean_mesh(METHOD, shape, held)
    if np.array_equal(sources, targets):
        return x.copy()
    centre, half = unit_of(x)
    try:
        moved = igl.harmonic((x - centre) / half, faces, held, (targets - sources) / half, 2)
    except RuntimeError as error:
        raise NotApplicable(f"{METHOD} cannot be solved on this mesh: libigl says '{error}'") from error
    return finite(METHOD, x + half * np.asarray(moved, dtype=np.float64))
