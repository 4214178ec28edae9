"""The planes by which a shape is its own mirror image."""

from __future__ import annotations

from numpy.typing import ArrayLike

from neuralmls import _core
from neuralmls.arrays import as_points
from neuralmls.errors import ArgumentError
from neuralmls.placement import MirrorPlane, as_indices
from neuralmls.shape import Shape


def symmetry(shape: Shape | ArrayLike, faces: ArrayLike | None = None) -> list[MirrorPlane]:
    """Return the planes by which a shape may be symmetric, the best first.

    2,000 places of the shape are mirrored by `x' = x - 2 (n . x - o) n` and looked for among 12,000 others; `n` and `o`
    are those that bring them nearest to the surface. A plane in which a flat shape itself lies is none.

    Parameters
    ----------
    shape : Shape, or points (n, d) float64
    faces : (f, 3) integers, optional
        Triangles of the points; without any they are a cloud.

    Returns
    -------
    list of MirrorPlane
        The first decides: where its verdict is "symmetric", so is the shape. Empty for a cloud of fewer than 8 points
        (4 in 1D), or where all are in one place.

    Raises
    ------
    ArgumentError
        There are no finite points, or a face names none.

    Examples
    --------
    >>> import numpy as np
    >>> half = np.random.default_rng(0).uniform(0, 1, (500, 3))
    >>> best = symmetry(np.concatenate([half, half * [-1, 1, 1]]))[0]
    >>> best.verdict, best.normal.round(6).tolist()
    ('symmetric', [1.0, 0.0, 0.0])
    """
    if isinstance(shape, Shape):
        if faces is not None:
            raise ArgumentError("faces: expected them beside an array of points, not beside a shape that has its own")
        x, faces = shape.positions, shape.faces
    else:
        x = as_points("shape", shape)
    planes = _core.mirror_planes(x, as_indices(faces, len(x)))
    return [MirrorPlane._of(plane, x.shape[1]) for plane in planes]
