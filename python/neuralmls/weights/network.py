"""Weights that a network gives: what trained networks have in common, whatever they were trained on."""

from __future__ import annotations

import os
import zipfile
from typing import Self, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from neuralmls import _core
from neuralmls.arrays import Progress, as_points
from neuralmls.errors import ArgumentError, FileError
from neuralmls.point_tree import PointTree
from neuralmls.protocol import Transform

FORMAT = "neuralmls-network-1"


class NetworkWeights:
    """A trained network `d -> width -> width -> m` whose outputs are the logits."""

    def __init__(
        self, control_points: NDArray[np.float64], network: _core.Network, losses: list[float], loss: float
    ) -> None:
        self._p = control_points.copy()
        self._p.flags.writeable = False
        self._network = network
        self._losses = np.array(losses, dtype=np.float64)
        self._loss = loss

    @property
    def control_points(self) -> NDArray[np.float64]:
        """The control points at rest, (m, d)."""
        return self._p

    @property
    def loss(self) -> float:
        """The mean cross-entropy after the training."""
        return self._loss

    @property
    def losses(self) -> NDArray[np.float64]:
        """The mean cross-entropy before each step."""
        return self._losses

    @property
    def steps(self) -> int:
        """The steps that were trained."""
        return len(self._losses)

    @final
    def logits(self, x: ArrayLike, *, progress: Progress | None = None) -> NDArray[np.float32]:
        """Return the logits of the points `x` (n, d), or of a `PointTree`: (n, m), in the points' own order.

        Raises
        ------
        ArgumentError
            `x` does not hold finite points of the control points' dimension, or is a tree of another box.
        """
        if isinstance(x, PointTree):
            return self._network.logits_of_tree(x._core, progress)
        return self._network.logits(as_points("x", x, self._p.shape[1]), progress)

    def _bind(
        self, x: ArrayLike, points: NDArray[np.float64], transform: Transform, progress: Progress | None
    ) -> _core.Deformer:
        """Bind `points`, which are `x`: what `Deformer` does with the logits of any weights, but nothing is copied."""
        tree = x._core if isinstance(x, PointTree) else None
        return _core.Deformer.of_network(points, self._p, self._network, tree, transform, progress)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write network and control points as an `.npz` file, which `load` and `numpy.load` read.

        Raises
        ------
        FileError
            The file cannot be written; what was there is untouched.
        """
        import io

        from neuralmls.files import write_atomically

        network = self._network
        arrays: dict[str, NDArray[np.generic]] = {
            "format": np.array(FORMAT),
            "control_points": self._p,
            "centre": np.array(network.centre),
            "half": np.array(network.half),
            "frequencies": network.frequencies,
            "losses": self._losses,
            "loss": np.array(self._loss),
        }
        for index, (weight, bias) in enumerate(network.layers):
            arrays |= {f"weight{index}": weight, f"bias{index}": bias}
        buffer = io.BytesIO()
        np.savez(buffer, allow_pickle=False, **arrays)
        write_atomically(path, buffer.getvalue())

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Self:
        """Read what `save` wrote.

        Raises
        ------
        FileError
            The file is missing or is not such a file.
        """
        try:
            with open(path, "rb") as file, np.load(file, allow_pickle=False) as stored:
                arrays = {name: stored[name] for name in stored.files}
            if str(arrays["format"]) != FORMAT:
                raise FileError(f"{path}: expected a network of format '{FORMAT}', found '{arrays['format']}'")
            p = as_points("control_points", arrays["control_points"])
            layers = [(_single(arrays[f"weight{index}"], 2), _single(arrays[f"bias{index}"], 1)) for index in range(3)]
            network = _core.Network(
                p.shape[1],
                arrays["centre"].tolist(),
                float(arrays["half"]),
                _single(arrays["frequencies"], 2),
                layers,
            )
            if len(layers[2][1]) != len(p):
                raise ArgumentError(f"the network has {len(layers[2][1])} outputs for {len(p)} control points")
            return cls(p, network, arrays["losses"].tolist(), float(arrays["loss"]))
        except FileError:
            raise
        except OSError as error:
            raise FileError(f"{path}: cannot read: {error.strerror or error}") from error
        except (KeyError, ValueError, TypeError, EOFError, AttributeError, zipfile.BadZipFile) as error:
            raise FileError(f"{path}: this is no network that `save` wrote: {error}") from error


def _single(array: NDArray[np.generic], dimensions: int) -> NDArray[np.float32]:
    if array.ndim != dimensions:
        raise ValueError(f"an array has {array.ndim} dimensions instead of {dimensions}")
    return np.ascontiguousarray(array, dtype=np.float32)
