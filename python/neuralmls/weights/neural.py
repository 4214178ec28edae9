"""The paper's weights: a network trained on nothing but the control points (Shechter et al. 2022, section 3)."""

from __future__ import annotations

from numpy.typing import ArrayLike

from neuralmls import _core
from neuralmls.arrays import Progress, as_box
from neuralmls.settings import changes_of
from neuralmls.weights.function import NetworkWeights, as_control_points


class NeuralWeights(NetworkWeights):
    """A network `d -> width -> width -> m` whose outputs are the logits; made by `fit` or `load`."""

    _kind = "neural"

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
            A fixed number of steps: 48 in the published code. Without it, until every control point has 0.9 of the
            weight at its own place (at most 2000), because handles that do not own their place stop short. 64
            control points or more then begin at an output layer in closed form, and mostly need no step.
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
        p = as_control_points(control_points)
        box = None if bounds is None else as_box(bounds, p.shape[1])
        parameters = {"seed": seed, "width": width, "steps": steps, "rate": rate, "fourier_sigma": fourier_sigma}
        return cls._of(_core.Weights.fitted(p, box, None, changes_of(cls._kind, parameters), progress))
