"""What every weight function has: control points, and logits at any place."""

from __future__ import annotations

import os
from typing import Any, Protocol, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from neuralmls import _core
from neuralmls import _core as core  # where a class has an attribute of that name
from neuralmls.arrays import Progress, as_points
from neuralmls.errors import ArgumentError, FileError
from neuralmls.files import read_file, write_atomically
from neuralmls.point_tree import PointTree


class HasLogits(Protocol):
    """Anything that `Deformer` and `ExactHandles` take for a weight function besides `Weights`."""

    @property
    def control_points(self) -> NDArray[np.float64]:
        """The control points at rest, (m, d)."""

    def logits(self, x: ArrayLike, *, progress: Progress | None = None) -> NDArray[np.float32]:
        """What it says of each of the points `x` (n, d), before the softmax: (n, m)."""


class Weights:
    """A weight function of m control points, given by its logits; made by `fit`, `load`, or the class of its kind."""

    _core: core.Weights
    _kind = ""

    @classmethod
    def _of(cls, made: core.Weights) -> Self:
        self = cls.__new__(cls)
        self._core = made
        return self

    @property
    def control_points(self) -> NDArray[np.float64]:
        """The control points at rest, (m, d)."""
        p = self._core.control_points
        p.flags.writeable = False
        return p

    def logits(self, x: ArrayLike, *, progress: Progress | None = None) -> NDArray[np.float32]:
        """Return the logits of the points `x` (n, d), or of a `PointTree`: (n, m), in the points' own order.

        `+infinity` on a control point where it has all the weight.

        Raises
        ------
        ArgumentError
            `x` does not hold finite points of the control points' dimension, or is a tree of another box.
        """
        if isinstance(x, PointTree):
            return self._core.logits_of_tree(x._core, progress)
        return self._core.logits(as_points("x", x, self._core.control_points.shape[1]), progress)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the weights, bit for bit, as a safetensors file, which `load` reads.

        Raises
        ------
        FileError
            The file cannot be written; what was there is untouched.
        """
        write_atomically(path, self._core.to_bytes())

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Self:
        """Read what `save` wrote, or the weights of a saved map. Nothing in the file is executed.

        Raises
        ------
        FileError
            The file is missing, is not such a file, or holds weights of another kind.
        """
        data = read_file(path)
        try:
            core = _core.Weights.from_bytes(data)
        except FileError as error:
            raise FileError(f"{path}: {error}") from None
        if core.kind != cls._kind:
            raise FileError(f"{path}: expected {cls._kind} weights, found {core.kind} ones")
        return cls._of(core)

    def __reduce__(self) -> tuple[Any, ...]:
        return _restored, (type(self), self._core.to_bytes())


class NetworkWeights(Weights):
    """A trained network `d -> width -> width -> m` whose outputs are the logits."""

    @property
    def loss(self) -> float:
        """The mean cross-entropy after the training."""
        return float(self._core.loss)  # type: ignore[arg-type]  # a network has one

    @property
    def losses(self) -> NDArray[np.float64]:
        """The mean cross-entropy before each step."""
        losses = self._core.losses
        assert losses is not None
        return losses

    @property
    def steps(self) -> int:
        """The steps that were trained."""
        return len(self.losses)


def as_control_points(values: ArrayLike) -> NDArray[np.float64]:
    """Return control points at rest (m, d), at least one.

    Raises
    ------
    ArgumentError
        They are no finite points, or none.
    """
    p = as_points("control_points", values)
    if not len(p):
        raise ArgumentError("control_points: expected at least one, found none")
    return p


def _restored(kind: type[Weights], data: bytes) -> Weights:
    return kind._of(_core.Weights.from_bytes(data))
