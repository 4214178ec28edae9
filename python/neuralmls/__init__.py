"""Deform any 3D shape by a few control points: NeuralMLS (Shechter et al. 2022), fast, with nothing lost.

>>> import numpy as np
>>> import neuralmls as nm
>>> x = np.random.default_rng(0).uniform(-1, 1, (100, 3))         # any points: a mesh's vertices, a cloud
>>> p = [[-1, 0, 0], [1, 0, 0], [0, 1, 0]]                        # control points at rest
>>> q = [[-1, 0, 0], [1, 0, 0], [0, 1.5, 0]]                      # and moved
>>> nm.deform(x, p, q, weights="inverse-distance").shape
(100, 3)
"""

from neuralmls._core import VERSION as __version__
from neuralmls.control_points import ControlPoints
from neuralmls.deform import deform
from neuralmls.deformer import Deformer
from neuralmls.errors import ArgumentError, ControlPointError, FileError, NeuralMLSError
from neuralmls.placement import farthest_points
from neuralmls.shape import Shape, read
from neuralmls.weights import InverseDistanceWeights, NeuralWeights, Weights, softmax

__all__ = [
    "ArgumentError",
    "ControlPointError",
    "ControlPoints",
    "Deformer",
    "FileError",
    "InverseDistanceWeights",
    "NeuralMLSError",
    "NeuralWeights",
    "Shape",
    "Weights",
    "__version__",
    "deform",
    "farthest_points",
    "read",
    "softmax",
]
