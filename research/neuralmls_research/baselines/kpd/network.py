"""The networks: keypoints of a shape, and how much each of them moves each vertex of the cage.

Both begin with a PointNet (Qi et al. 2017) without normalisation layers. All vertices go in, so that nothing is random.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from neuralmls.errors import NeuralMLSError

Array = NDArray[np.float64]
Tensors = Mapping[str, NDArray[Any]]

CAGE = 42  # vertices
LEAK = 0.1
BLOCK = 4096  # points at a time


def shapes(count: int) -> dict[str, tuple[int, ...]]:
    """The tensors of a network of `count` keypoints, by name as in the published checkpoints."""
    wide = CAGE * count
    layers = {
        "keypoint_predictor.0.1.linear": (256, 256),
        "keypoint_predictor.1.layers.0.linear": (512, 256),
        "keypoint_predictor.1.layers.1.linear": (256, 512),
        "keypoint_predictor.1.layers.2.linear": (3 * count, 256),
        "influence_predictor.0.1.linear": (wide, wide),
        "influence_predictor.1.0.linear": (wide, wide),
        "influence_predictor.1.1.linear": (wide, wide),
    }
    for head, size in (("keypoint_predictor", 256), ("influence_predictor", wide)):
        for i, (after, before) in enumerate([(64, 3), (128, 64), (size, 128)], start=1):
            layers[f"{head}.0.0.conv{i}.conv"] = (after, before)
    result: dict[str, tuple[int, ...]] = {"influence_param": (count, CAGE)}
    for name, (after, before) in layers.items():
        result[f"{name}.weight"] = (after, before, 1) if ".conv" in name else (after, before)
        result[f"{name}.bias"] = (after,)
    return result


def checked(tensors: Tensors) -> dict[str, Array]:
    """Return the tensors of a network in double precision, those of convolutions as matrices.

    Raises
    ------
    NeuralMLSError
        One is missing, of another shape, or not finite.
    """
    param = tensors.get("influence_param")
    if param is None or param.ndim != 2 or not 1 <= len(param) <= 1000:
        raise NeuralMLSError(
            "expected a tensor 'influence_param' of shape (keypoints, 42): this is no KeypointDeformer"
        )
    result = {}
    for name, shape in shapes(len(param)).items():
        tensor = tensors.get(name)
        if tensor is None or tensor.shape != shape:
            found = "none" if tensor is None else f"one of shape {tensor.shape}"
            raise NeuralMLSError(f"expected a tensor '{name}' of shape {shape}, found {found}")
        if tensor.dtype.kind != "f" or not np.isfinite(tensor).all():
            raise NeuralMLSError(f"expected the tensor '{name}' to hold finite numbers")
        result[name] = tensor.astype(np.float64).reshape(shape[:2])
    return result


def keypoints(layers: Mapping[str, Array], x: Array) -> Array:
    """Return the keypoints (K, 3) of a normalised shape's vertices `x` (n, 3), each coordinate in [-1, 1]."""
    code = _leaky(_linear(layers, "keypoint_predictor.0.1.linear", _point_net(layers, "keypoint_predictor", x)))
    for i in range(2):
        code = _leaky(_linear(layers, f"keypoint_predictor.1.layers.{i}.linear", code))
    raw = _linear(layers, "keypoint_predictor.1.layers.2.linear", code)
    return np.clip(raw.reshape(3, -1).T, -1.0, 1.0)  # the dimension comes first in the file


def influence(layers: Mapping[str, Array], x: Array) -> Array:
    """Return how much each keypoint moves each vertex of the cage, (K, 42), before those far from it are left out."""
    code = _point_net(layers, "influence_predictor", x)
    code = _leaky(_linear(layers, "influence_predictor.0.1.linear", code))
    code = _leaky(_linear(layers, "influence_predictor.1.0.linear", code))
    offset = _linear(layers, "influence_predictor.1.1.linear", code)
    return layers["influence_param"] + offset.reshape(-1, CAGE)


def near(points: Array, cage: Array) -> NDArray[np.bool_]:
    """Return which vertices of the cage each keypoint may move, (K, 42): the max(5, 42 / K) that are nearest to it."""
    squared = ((points[:, None] - cage) ** 2).sum(axis=2)
    n = max(5, CAGE // len(points))
    kept: NDArray[np.bool_] = squared <= np.sort(squared, axis=1)[:, n - 1 : n]
    return kept


def _linear(layers: Mapping[str, Array], name: str, x: Array) -> Array:
    y: Array = x @ layers[f"{name}.weight"].T + layers[f"{name}.bias"]
    return y


def _leaky(x: Array) -> Array:
    return np.maximum(x, LEAK * x)


def _point_net(layers: Mapping[str, Array], head: str, x: Array) -> Array:
    """Three linear layers at each point, and the maximum over the points."""
    largest: list[Array] = []
    for start in range(0, len(x), BLOCK):
        code = x[start : start + BLOCK]
        for i in (1, 2):
            code = np.maximum(_linear(layers, f"{head}.0.0.conv{i}.conv", code), 0.0)
        largest.append(_linear(layers, f"{head}.0.0.conv3.conv", code).max(axis=0))
    whole: Array = np.max(largest, axis=0)
    return whole
