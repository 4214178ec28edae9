"""The paper's weights: a network trained on nothing but the control points (Shechter et al. 2022, section 3)."""

from __future__ import annotations

import os
import zipfile

import numpy as np
from numpy.typing import ArrayLike, NDArray

from neuralmls import _core
from neuralmls.arrays import Progress, as_box, as_count, as_number, as_points, box_around
from neuralmls.errors import ArgumentError, FileError
from neuralmls.point_tree import PointTree

FORMAT = "neuralmls-network-1"


class NeuralWeights:
    """A network `d -> width -> width -> m` whose outputs are the logits; made by `fit` or `load`."""

    def __init__(
        self, control_points: NDArray[np.float64], network: _core.Network, losses: list[float], loss: float
    ) -> None:
        self._p = control_points.copy()
        self._p.flags.writeable = False
        self._network = network
        self._losses = np.array(losses, dtype=np.float64)
        self._loss = loss

    @classmethod
    def fit(
        cls,
        control_points: ArrayLike,
        *,
        bounds: ArrayLike | None = None,
        seed: int = 0,
        width: int = 1024,
        steps: int | None = None,
        rate: float = 6e-4,
        fourier_sigma: float | None = None,
        progress: Progress | None = None,
    ) -> NeuralWeights:
        """Train a network to tell which control point a place belongs to.

        Full-batch cross-entropy of control point i against class i, Adam, the last fifth of the steps at a tenth
        of the rate. The targets are not needed: one fit serves every drag.

        Parameters
        ----------
        control_points : (m, d), 1 to 1,000 of them, d = 1, 2 or 3
        bounds : (2, d), optional
            The shape's box: coordinates are centred on it and divided by half of its longest side. Without it, the
            box of the control points.
        seed : int, 0 to 2^64 - 1
            The same seed gives the same bytes, whatever the number of threads or the order of the control points.
        width : int, 1 to 16384
            Neurons a hidden layer: 1024 in the paper.
        steps : int, optional
            A fixed number of steps: 48 in the paper. Without it, until every control point has 0.9 of the weight
            at its own place (at most 2000), because handles that do not own their place stop short.
        rate : float > 0
            Adam's learning rate.
        fourier_sigma : float > 0, optional
            Adds 32 random Fourier features of this deviation (cycles a unit), for weights that change faster.
        progress : callable, optional
            Told the fraction done, from 0 to 1; what it raises stops the training.

        Raises
        ------
        ArgumentError
            A number is out of its range, the control points are not finite points, or two are in one place.

        Examples
        --------
        >>> weights = NeuralWeights.fit([[-1.0, 0.0], [1.0, 0.0]], width=64, seed=1)
        >>> weights.logits([[-0.9, 0.1]]).argmax()
        np.int64(0)
        """
        p = as_points("control_points", control_points)
        check_training(seed, width, steps)
        as_number("rate", rate, 0)
        if fourier_sigma is not None:
            as_number("fourier_sigma", fourier_sigma, 0)
        centre, half = box_around(p) if bounds is None else as_box(bounds, p.shape[1])
        network, losses, loss = _core.fit(p, centre, half, width, steps, rate, seed, fourier_sigma, progress)
        return cls(p, network, losses, loss)

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
    def load(cls, path: str | os.PathLike[str]) -> NeuralWeights:
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
            raise FileError(f"{path}: this is no network that NeuralWeights.save wrote: {error}") from error


def check_training(seed: int, width: int, steps: int | None) -> None:
    """Refuse what `NeuralWeights.fit` would.

    Raises
    ------
    ArgumentError
        A number is out of its range.
    """
    as_count("seed", seed, 0, 2**64 - 1)
    as_count("width", width, 1, 1 << 14)
    if steps is not None:
        as_count("steps", steps, 1, 1_000_000)


def _single(array: NDArray[np.generic], dimensions: int) -> NDArray[np.float32]:
    if array.ndim != dimensions:
        raise ValueError(f"an array has {array.ndim} dimensions instead of {dimensions}")
    return np.ascontiguousarray(array, dtype=np.float32)
