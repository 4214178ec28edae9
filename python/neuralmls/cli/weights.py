"""The options that choose a weight function, shared by the commands that need one."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import wraps
from typing import TYPE_CHECKING, Any, Literal, TypeAlias, TypeVar, cast, get_args

import click

from neuralmls.cli import options
from neuralmls.errors import ArgumentError

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from neuralmls.weights import InverseDistanceWeights, NeuralWeights

Kind: TypeAlias = Literal["neural", "inverse-distance"]

Function = TypeVar("Function", bound=Callable[..., Any])

_OPTIONS = (
    click.option(
        "--weights",
        type=click.Choice(get_args(Kind)),
        default="neural",
        help="Learned from the control points, or the classic ones.",
    ),
    options.temperature,
    click.option("--alpha", type=float, help="Inverse-distance: exponent of the squared distance; 1 if not given."),
    click.option(
        "--epsilon",
        type=float,
        help="Inverse-distance: above 0 caps the weight near a control point; "
        "distances count in halves of the shape's longest side.",
    ),
    click.option("--width", type=int, help="Neural: neurons of a hidden layer; 1024 if not given."),
    click.option("--steps", type=int, help="Neural: steps of the training; until the loss is small if not given."),
    click.option("--seed", type=int, help="Neural: seed of the training; 0 if not given."),
)


def weights_options(function: Function) -> Function:
    """Add the options of a `WeightsChoice`, which the function gets as `choice`, and the temperature."""

    @wraps(function)
    def chosen(**arguments: Any) -> Any:
        names = ("weights", "alpha", "epsilon", "width", "steps", "seed")
        return function(choice=WeightsChoice(*(arguments.pop(name) for name in names)), **arguments)

    for option in reversed(_OPTIONS):
        chosen = option(chosen)
    return cast(Function, chosen)


@dataclass(frozen=True)
class WeightsChoice:
    """A kind of weights and its parameters, None where the person left them open.

    Raises
    ------
    ArgumentError
        A parameter belongs to the other kind.
    """

    kind: Kind
    alpha: float | None = None
    epsilon: float | None = None
    width: int | None = None
    steps: int | None = None
    seed: int | None = None

    def __post_init__(self) -> None:
        other, names = (
            ("inverse-distance", ("alpha", "epsilon"))
            if self.kind == "neural"
            else ("neural", ("width", "steps", "seed"))
        )
        for name in names:
            if getattr(self, name) is not None:
                raise ArgumentError(f"--{name} belongs to --weights {other}, but the weights are {self.kind}")

    @property
    def stage(self) -> str:
        """The name of the stage in which they are made."""
        return "train" if self.kind == "neural" else "bind"

    def check(self) -> None:
        """Refuse parameters out of their range, before anything is read.

        Raises
        ------
        ArgumentError
            There is one.
        """
        from neuralmls.weights import InverseDistanceWeights
        from neuralmls.weights.neural import check_training

        given = self._options("seed", "width", "steps")
        check_training(**{"seed": 0, "width": 1, "steps": None, **given})
        InverseDistanceWeights([[0.0]], **self._options("alpha", "epsilon"))

    def make(
        self, sources: NDArray[np.float64], bounds: NDArray[np.float64], progress: Callable[[float], None]
    ) -> NeuralWeights | InverseDistanceWeights:
        """Train the network, or set up the classic weights.

        Raises
        ------
        ArgumentError
            A parameter is out of its range.
        """
        from neuralmls.weights import InverseDistanceWeights, NeuralWeights

        if self.kind == "neural":
            training = self._options("width", "steps", "seed")
            return NeuralWeights.fit(sources, bounds=bounds, progress=progress, **training)
        return InverseDistanceWeights(sources, bounds=bounds, **self._options("alpha", "epsilon"))

    def _options(self, *names: str) -> dict[str, Any]:
        """The parameters of these names that the person gave."""
        return {name: getattr(self, name) for name in names if getattr(self, name) is not None}
