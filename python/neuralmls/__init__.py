"""Deform any 3D shape by a few control points: NeuralMLS (Shechter et al. 2022), fast, with nothing lost.

>>> import numpy as np
>>> import neuralmls as nm
>>> x = np.random.default_rng(0).uniform(-1, 1, (100, 3))         # any points: a mesh's vertices, a cloud
>>> p = [[-1, 0, 0], [1, 0, 0], [0, 1, 0]]                        # control points at rest
>>> q = [[-1, 0, 0], [1, 0, 0], [0, 1.5, 0]]                      # and moved
>>> nm.deform(x, p, q, weights="inverse-distance").shape          # all in one call
(100, 3)
>>> map = nm.Session(nm.ControlPoints(p, q)).fit(x)               # or fitted once: a map of space, to be kept
>>> map.at(x).shape
(100, 3)
"""

from importlib import import_module
from typing import TYPE_CHECKING

from neuralmls._core import VERSION as __version__

if TYPE_CHECKING:
    from neuralmls.advice import advise
    from neuralmls.control_points import ControlPoints
    from neuralmls.deformer import Deformer
    from neuralmls.errors import ArgumentError, ControlPointError, FileError, NeuralMLSError, NotApplicable
    from neuralmls.handles import Aim, ExactHandles, Soft
    from neuralmls.orientations import Orientation
    from neuralmls.pipeline import deform
    from neuralmls.placement import MirrorPlane, Placed, farthest_of, farthest_points, place
    from neuralmls.point_tree import PointTree
    from neuralmls.report import Advice, Report
    from neuralmls.session import Map, Session
    from neuralmls.shape import Shape, read
    from neuralmls.symmetries import symmetry
    from neuralmls.weights import InverseDistanceWeights, NeuralWeights, ShapeAwareWeights, Weights
    from neuralmls.weights.softmax import softmax

__all__ = [
    "Advice",
    "Aim",
    "ArgumentError",
    "ControlPointError",
    "ControlPoints",
    "Deformer",
    "ExactHandles",
    "FileError",
    "InverseDistanceWeights",
    "Map",
    "MirrorPlane",
    "NeuralMLSError",
    "NeuralWeights",
    "NotApplicable",
    "Orientation",
    "Placed",
    "PointTree",
    "Report",
    "Session",
    "Shape",
    "ShapeAwareWeights",
    "Soft",
    "Weights",
    "__version__",
    "advise",
    "deform",
    "farthest_of",
    "farthest_points",
    "place",
    "read",
    "softmax",
    "symmetry",
]

# Which module has which name. They are imported when first asked for: `neuralmls --help` need not wait for numpy.
# No module may be called like a name that another one gives: importing it would hide that name.
_HOMES = {
    "Advice": "report",
    "Aim": "handles",
    "ArgumentError": "errors",
    "ControlPointError": "errors",
    "ControlPoints": "control_points",
    "Deformer": "deformer",
    "ExactHandles": "handles",
    "FileError": "errors",
    "InverseDistanceWeights": "weights",
    "Map": "session",
    "MirrorPlane": "placement",
    "NeuralMLSError": "errors",
    "NeuralWeights": "weights",
    "NotApplicable": "errors",
    "Orientation": "orientations",
    "Placed": "placement",
    "PointTree": "point_tree",
    "Report": "report",
    "Session": "session",
    "Shape": "shape",
    "ShapeAwareWeights": "weights",
    "Soft": "handles",
    "Weights": "weights",
    "advise": "advice",
    "deform": "pipeline",
    "farthest_of": "placement",
    "farthest_points": "placement",
    "place": "placement",
    "read": "shape",
    "softmax": "weights.softmax",
    "symmetry": "symmetries",
}


def __getattr__(name: str) -> object:
    if name not in _HOMES:
        raise AttributeError(f"module 'neuralmls' has no attribute '{name}'")
    value: object = getattr(import_module(f"neuralmls.{_HOMES[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
