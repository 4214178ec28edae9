"""KeypointDeformer: a network read once, bound to a shape once, which it then deforms many times.

Jakab, Tucker, Makadia, Wu, Snavely, Kanazawa, "KeypointDeformer: Unsupervised 3D Keypoint Discovery for Shape
Control", CVPR 2021. What differs: everything runs in double precision, and the coordinates of the vertices in the cage
are computed once for a shape, not for each deformation.
"""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from neuralmls.errors import ArgumentError, FileError, NeuralMLSError, NotApplicable
from neuralmls.plugin import as_path, as_points
from neuralmls_research.baselines.checks import library
from neuralmls_research.baselines.kpd import network
from neuralmls_research.baselines.kpd.cage import draw_in, icosphere
from neuralmls_research.baselines.kpd.mean_value import mean_value_coordinates

Array = NDArray[np.float64]


def normalise(x: Array) -> tuple[Array, Array, float]:
    """Return the points with their box's centre at 0 and a largest coordinate of 1; the centre, and the scale.

    Raises
    ------
    NotApplicable
        The points are not in space, or all in one place.
    """
    if len(x) == 0 or x.shape[1] != 3:
        raise NotApplicable("KeypointDeformer needs points in space")
    centre = (x.min(axis=0) + x.max(axis=0)) / 2
    scale = float(np.abs(x - centre).max())
    if scale == 0:
        raise NotApplicable("KeypointDeformer needs a shape of some size, and all points are in one place")
    return (x - centre) / scale, centre, scale


@dataclass(frozen=True, eq=False)
class BoundKeypoints:
    """A shape with its keypoints, bound by `KeypointDeformer.bind`.

    Attributes
    ----------
    keypoints : (K, 3) float64, in the coordinates of the file
    centre, scale : what the shape was normalised by; the cage and the influence are of the normalised shape
    cage : (42, 3) float64
    influence : (K, 42) float64
    coordinates : (n, 42) float64, the mean value coordinates of the vertices in the cage
    """

    keypoints: Array
    centre: Array
    scale: float
    cage: Array
    influence: Array
    coordinates: Array
    _rest: Array

    def deform(self, targets: ArrayLike) -> Array:
        """Return the vertices (n, 3) when the keypoints go to `targets` (K, 3), in the coordinates of the file.

        `x' = w (cage + influence^T (targets - keypoints))`. If none moves, the vertices bit for bit.

        Raises
        ------
        ArgumentError
            The targets are not as many finite points as there are keypoints.
        """
        moved = as_points("targets", targets, 3)
        if len(moved) != len(self.keypoints):
            raise ArgumentError(
                f"targets: expected one for each of {len(self.keypoints)} keypoints, found {len(moved)}"
            )
        if np.array_equal(moved, self.keypoints):
            return self._rest.copy()
        offsets = (moved - self.keypoints) / self.scale
        # The displacement alone: w cage is the vertex itself, but for rounding.
        return self._rest + self.scale * (self.coordinates @ (self.influence.T @ offsets))


class HasPositions(Protocol):
    """What keypoints are found on: a `Shape`, or anything that has its positions."""

    @property
    def positions(self) -> Array:
        """(n, 3)."""


class KeypointDeformer:
    """The network: finds the keypoints of a shape of its category, and deforms the shape by them.

    Parameters
    ----------
    tensors : mapping of names to arrays
        As in the published checkpoints; `KeypointDeformer.read` reads them from a file.

    Raises
    ------
    NeuralMLSError
        A tensor is missing, of another shape, or not finite.
    """

    def __init__(self, tensors: network.Tensors) -> None:
        self._layers = network.checked(tensors)

    @property
    def count(self) -> int:
        """The number of keypoints."""
        return len(self._layers["influence_param"])

    @classmethod
    def read(cls, path: str | os.PathLike[str]) -> KeypointDeformer:
        """Read a `.safetensors` file: `neuralmls convert-kpd` makes one of a published checkpoint.

        Raises
        ------
        FileError
            The file is missing, is no such file, or lacks a tensor.
        NeuralMLSError
            safetensors is not installed.
        """
        source = as_path("path", path)
        safetensors = library("safetensors.numpy")
        try:
            return cls(safetensors.load(source.read_bytes()))
        except OSError as error:
            raise FileError(f"{source}: cannot read: {error.strerror or error}") from error
        except (library("safetensors").SafetensorError, KeyError) as error:
            raise FileError(f"{source}: expected a .safetensors file: {error}") from error
        except NeuralMLSError as error:
            raise FileError(f"{source}: {error}") from error

    def keypoints(self, shape: HasPositions) -> Array:
        """Return a shape's keypoints alone, (K, 3), in the coordinates of the file.

        Raises
        ------
        NotApplicable
            The shape is not in space, or has no size.
        """
        x, centre, scale = normalise(shape.positions)
        return network.keypoints(self._layers, x) * scale + centre

    def bind(self, shape: HasPositions) -> BoundKeypoints:
        """Find a shape's keypoints, its cage, and its vertices' coordinates in it.

        Raises
        ------
        NotApplicable
            The shape is not in space, or has no size.
        NeuralMLSError
            SciPy is not installed.
        """
        x, centre, scale = normalise(shape.positions)
        keypoints = network.keypoints(self._layers, x)
        sphere, faces = icosphere()
        cage = draw_in(sphere, x)
        influence = network.influence(self._layers, x) * network.near(keypoints, cage)
        coordinates = mean_value_coordinates(x, cage, faces)
        return BoundKeypoints(keypoints * scale + centre, centre, scale, cage, influence, coordinates, shape.positions)
