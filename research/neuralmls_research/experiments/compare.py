"""Methods side by side on one shape: what each does to it, how long it takes, or why it cannot."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass
from importlib import import_module
from time import perf_counter

from numpy.typing import ArrayLike

from neuralmls.errors import ArgumentError, ControlPointError, FileError, NeuralMLSError
from neuralmls_research.experiments.methods import Array, Geometry, Method
from neuralmls_research.metrics import Measures, measure


@dataclass(frozen=True)
class Result:
    """What a method made of a shape.

    Attributes
    ----------
    title : str
        The method's.
    positions : (n, d) or None
        The vertices deformed; None, like seconds and measures, where the method cannot do the shape.
    seconds : float or None
        From the shape and its control points to the positions, training included.
    measures : Measures or None
    reason : str or None
        Why the method cannot do the shape, in a sentence.
    """

    title: str
    positions: Array | None = None
    seconds: float | None = None
    measures: Measures | None = None
    reason: str | None = None


def load_libraries() -> None:
    """Import what the baselines need, so that no method's time has that in it; what is not installed is passed over."""
    for module in ("scipy.interpolate", "scipy.sparse.csgraph", "scipy.spatial", "igl"):
        with suppress(ImportError):
            import_module(module)


def attempt(method: Method, shape: Geometry, p: ArrayLike, q: ArrayLike) -> Result:
    """Deform a shape by a method, and measure the result.

    A method that does not apply, or whose library is not installed, gives a `Result` with the reason.

    Parameters
    ----------
    method : Method
    shape : Shape or Surface
    p, q : (m, d), the control points at rest and moved, in the coordinates of the shape

    Raises
    ------
    ArgumentError
        The control points do not fit the shape or each other.

    Examples
    --------
    >>> import numpy as np
    >>> from neuralmls_research.experiments.methods import METHODS, Surface
    >>> cloud = Surface(np.eye(3), None)
    >>> result = attempt(METHODS["classic"], cloud, cloud.positions, 2 * cloud.positions)
    >>> result.measures.at_points, attempt(METHODS["arap"], cloud, np.eye(3), 2 * np.eye(3)).positions is None
    (0.0, True)
    """
    start = perf_counter()
    try:
        bound = method.bind(shape, p)
        y = bound.positions(q)
        seconds = perf_counter() - start
        f = None if bound.space is None else bound.space(q)
    except (ArgumentError, ControlPointError, FileError):
        raise
    except NeuralMLSError as error:
        return Result(method.title, reason=str(error))
    return Result(method.title, y, seconds, measure(shape.positions, y, shape.faces, p, q, f=f))
