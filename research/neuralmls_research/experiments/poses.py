"""True poses as the measure: does a deformation put every vertex where it really goes?

A file holds the same vertices at rest and in several poses. Control points are put on the rest shape, moved to where
they are in a pose, and every other vertex is compared with that pose.
"""

from __future__ import annotations

import os
import zipfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from neuralmls import farthest_of
from neuralmls.errors import ArgumentError, FileError
from neuralmls.plugin import as_points, as_triangles
from neuralmls_research.experiments.loose_parts import with_loose_parts
from neuralmls_research.experiments.methods import METHODS, Array, Method, Surface, classic, neural

MOST = 6  # poses of a file, spread evenly over it

ALPHA = 2.0  # of the classic weights: 1/d^4 is their best here, and a rival is to be at its best
OF_SURFACES = ("arap", "arap-from-fit", "biharmonic", "biharmonic-displacements")
# The methods as they were first measured: enough steps for 40 control points to arrive.
POSE_METHODS: dict[str, Method] = METHODS | {
    "classic": classic(alpha=ALPHA),
    "neural": neural(steps=200),
    "neural-exact": neural(steps=200, adherence=1.0),
    "neural-relax": neural(steps=200, adherence=1.0, relax=1.0),
    **{name: with_loose_parts(METHODS[name]) for name in OF_SURFACES},
}

QUICK = tuple(name for name in POSE_METHODS if name != "biharmonic")  # its weights take ten times as long


def is_ours(method: Method) -> bool:
    """Whether a method is of this package, and not a rival: weights that are learned."""
    return method.seed is not None


@dataclass(frozen=True)
class Poses:
    """A surface at rest, (n, 3), and the same vertices in several poses, (k, n, 3)."""

    name: str
    rest: Surface
    poses: Array


def read_poses(path: str | os.PathLike[str]) -> Poses:
    """Read an `.npz` file with `rest` (n, 3), `poses` (k, n, 3) and `faces` (f, 3); other arrays in it are passed over.

    Raises
    ------
    FileError
        The file cannot be read, an array is missing or does not fit the others.
    """
    try:
        with open(path, "rb") as file, np.load(file, allow_pickle=False) as stored:
            arrays = {name: stored[name] for name in ("rest", "poses", "faces")}
    except OSError as error:
        raise FileError(f"{path}: cannot read: {error.strerror or error}") from error
    except KeyError as error:
        raise FileError(f"{path}: expected the arrays rest, poses and faces: {error.args[0]}") from error
    except (ValueError, TypeError, EOFError, AttributeError, zipfile.BadZipFile) as error:
        raise FileError(f"{path}: this is no .npz file of arrays: {error}") from error
    try:
        return _poses(Path(path).stem, **arrays)
    except ArgumentError as error:
        raise FileError(f"{path}: {error}") from None


def pose_errors(poses: Poses, method: Method, count: int) -> list[float]:
    """Return how far vertices end from where they are, for each of at most `MOST` poses.

    `count` vertices, chosen by farthest-point sampling of the rest positions from the one farthest from their
    centroid on, are the control points.

    Returns
    -------
    the mean distance over all vertices, in % of the diagonal of the rest shape's box

    Raises
    ------
    ArgumentError
        There are fewer distinct vertices than `count`.
    NotApplicable
        The method cannot do the shape; the message says why.

    Examples
    --------
    >>> corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    >>> moved = Poses("moved", Surface(corners, np.array([[0, 1, 2], [0, 2, 3]])), corners[None] + 1)
    >>> pose_errors(moved, classic(), 3)
    [0.0]
    """
    x = poses.rest.positions
    chosen = farthest_of(x, count)
    if len(chosen) < count:
        raise ArgumentError(f"{poses.name}: expected at most {len(chosen)} control points, found {count}")
    diagonal = float(np.linalg.norm(np.ptp(x, axis=0)))
    which = np.linspace(0, len(poses.poses) - 1, min(MOST, len(poses.poses))).astype(int)
    errors = []
    bound = method.bind(poses.rest, x[chosen])
    for pose in poses.poses[which]:
        y = bound.positions(pose[chosen])
        errors.append(100 * float(np.linalg.norm(y - pose, axis=1).mean()) / diagonal)
    return errors


def _poses(name: str, rest: NDArray[Any], poses: NDArray[Any], faces: NDArray[Any]) -> Poses:
    x = as_points("rest", rest, 3)
    if len(x) < 2 or (x == x[0]).all():
        raise ArgumentError("rest: expected at least two vertices in different places")
    if poses.ndim != 3 or poses.shape[1:] != x.shape or not len(poses):
        raise ArgumentError(f"poses: expected an array of shape (poses, {len(x)}, 3), found {poses.shape}")
    moved = np.stack([as_points(f"pose {number}", pose, 3) for number, pose in enumerate(poses)])
    return Poses(name, Surface(x, as_triangles(faces, len(x))), moved)
