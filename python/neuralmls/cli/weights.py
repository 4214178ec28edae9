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

    from neuralmls.shape import Shape
    from neuralmls.weights import InverseDistanceWeights, NeuralWeights, ShapeAwareWeights

Kind: TypeAlias = Literal["neural", "shape-aware", "inverse-distance"]

PARAMETERS: dict[Kind, tuple[str, ...]] = {
    "neural": ("width", "steps", "seed"),
    "shape-aware": ("seed",),
    "inverse-distance": ("alpha", "epsilon"),
}

Function = TypeVar("Function", bound=Callable[..., Any])

_OPTIONS = (
    click.option(
        "--weights",
        type=click.Choice(get_args(Kind)),
        default="neural",
        help="Learned from the control points, from the shape too, or the classic ones.",
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
    click.option("--seed", type=int, help="Neural, shape-aware: seed of the training; 0 if not given."),
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
        A parameter belongs to another kind.
    """

    kind: Kind
    alpha: float | None = None
    epsilon: float | None = None
    width: int | None = None
    steps: int | None = None
    seed: int | None = None

    def __post_init__(self) -> None:
        for kind, names in PARAMETERS.items():
            for name in names:
                if getattr(self, name) is not None and name not in PARAMETERS[self.kind]:
                    raise ArgumentError(f"--{name} belongs to --weights {kind}, but the weights are {self.kind}")

    @property
    def stage(self) -> str:
        """The name of the stage in which they are made."""
        return "bind" if self.kind == "inverse-distance" else "train"

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
        self, sources: NDArray[np.float64], shape: Shape, progress: Callable[[float], None]
    ) -> NeuralWeights | ShapeAwareWeights | InverseDistanceWeights:
        """Train the network, or set up the classic weights.

        Raises
        ------
        ArgumentError
            A parameter is out of its range.
        NeuralMLSError
            Shape-aware weights need SciPy, and it is not installed.
        """
        from neuralmls.weights import InverseDistanceWeights, NeuralWeights, ShapeAwareWeights

        given = self._options(*PARAMETERS[self.kind])
        if self.kind == "neural":
            return NeuralWeights.fit(sources, bounds=shape.bounds, progress=progress, **given)
        if self.kind == "shape-aware":
            return ShapeAwareWeights.fit(
                sources, shape.positions, shape.faces, bounds=shape.bounds, progress=progress, **given
            )
        return InverseDistanceWeights(sources, bounds=shape.bounds, **given)

    def _options(self, *names: str) -> dict[str, Any]:
        """The parameters of these names that the person gave."""
        return {name: getattr(self, name) for name in names if getattr(self, name) is not None}
