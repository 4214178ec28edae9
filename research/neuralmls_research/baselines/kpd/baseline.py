"""KeypointDeformer as a baseline: its keypoints go with the control points that lie on them."""

from __future__ import annotations

import os

import numpy as np
from numpy.typing import ArrayLike, NDArray

from neuralmls import Shape
from neuralmls.errors import NotApplicable
from neuralmls_research.baselines.checks import arguments, library
from neuralmls_research.baselines.kpd.model import BoundKeypoints, KeypointDeformer

# How far a control point may lie from its keypoint, in halves of the shape's longest side.
BESIDE = 0.1


def kpd(
    shape: Shape,
    p: ArrayLike,
    q: ArrayLike,
    *,
    network: KeypointDeformer | BoundKeypoints | str | os.PathLike[str] | None = None,
) -> NDArray[np.float64]:
    """Return the vertices deformed by KeypointDeformer: each keypoint moves as the control point that lies on it.

    KeypointDeformer chooses its keypoints itself, so control points have to be put where those are, as in the paper's
    comparison: `KeypointDeformer.read(path).bind(shape).keypoints`. A keypoint without a control point stays. The shape
    must be of the category that the network was trained on, in that category's orientation. Other
    arguments, the result and further errors: `neuralmls_research.baselines`.

    Parameters
    ----------
    network : KeypointDeformer, or the path of its `.safetensors` file; or the network bound to this shape
        The last saves time where one shape is deformed often.

    Raises
    ------
    NotApplicable
        There is no network; there are more control points than keypoints, or one has no keypoint within a tenth of half
        of the shape's longest side; the shape is not in space, or has no size.
    FileError
        The network's file cannot be used.

    Source
    ------
    Jakab et al., CVPR 2021.
    """
    _, sources, targets = arguments("KeypointDeformer", shape, p, q)
    if network is None:
        raise NotApplicable("KeypointDeformer needs a network trained for the shape's category: a .safetensors file")
    if isinstance(network, str | os.PathLike):
        network = KeypointDeformer.read(network)
    bound = network.bind(shape) if isinstance(network, KeypointDeformer) else network
    distance = np.linalg.norm(bound.keypoints[:, None] - sources, axis=2) / bound.scale
    if len(sources) > len(bound.keypoints):
        raise NotApplicable(
            f"KeypointDeformer moves its own {len(bound.keypoints)} keypoints, "
            f"and there are {len(sources)} control points"
        )
    keypoint, control = library("scipy.optimize").linear_sum_assignment(distance)
    far = distance[keypoint, control]
    if far.max() > BESIDE:
        i = int(far.argmax())
        raise NotApplicable(
            f"KeypointDeformer moves its own keypoints, and control point {control[i]} has none nearby: "
            f"the one left for it is {far[i]:.2g} of half of the shape's longest side away"
        )
    goals = bound.keypoints.copy()
    goals[keypoint] += targets[control] - sources[control]
    return bound.deform(goals)
