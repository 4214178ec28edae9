"""Classic moving least squares (Schaefer, McPhail, Warren 2006; Zhu, Gortler 2007): the paper's first rival."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from neuralmls import Deformer, InverseDistanceWeights, Shape
from neuralmls.plugin import Transform


def classic(
    shape: Shape,
    p: ArrayLike,
    q: ArrayLike,
    *,
    alpha: float = 1.0,
    temperature: float = 1.0,
    transform: Transform = "rigid",
) -> NDArray[np.float64]:
    """Return the vertices deformed by `y = M (x - p*) + q*` with the weights `1 / d^(2 alpha)`.

    It takes any shape, of any dimension d. Arguments and result: `neuralmls_research.baselines`.

    Parameters
    ----------
    alpha : float > 0
        Exponent of the *squared* distance: 0.5 is 1/d.
    temperature : float > 0
    transform : "rigid", "similarity" or "affine"

    Raises
    ------
    ArgumentError
        An argument is out of its range, or does not fit another.

    Examples
    --------
    >>> import tempfile, pathlib, neuralmls as nm
    >>> path = pathlib.Path(tempfile.mkdtemp(), "two.xyz")
    >>> _ = path.write_text("0 0 0\\n1 0 0\\n")
    >>> classic(nm.read(path), [[0, 0, 0], [1, 0, 0]], [[0, 0, 0], [1, 1, 0]]).tolist()
    [[0.0, 0.0, 0.0], [1.0, 1.0, 0.0]]
    """
    y: NDArray[np.float64] = Deformer(
        shape.positions, InverseDistanceWeights(p, alpha=alpha), transform=transform
    ).deform(q, temperature)  # type: ignore[assignment]  # float64, as the positions are
    return y
