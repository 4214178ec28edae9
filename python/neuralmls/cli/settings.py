"""The options that say how to deform: what a person says goes before what a session has."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import Any, TypeVar, cast, get_args

import click

from neuralmls.settings import HandlesName, Transform, WeightsName

Function = TypeVar("Function", bound=Callable[..., Any])


class HandlesType(click.ParamType[str | float]):
    """How closely control points arrive: a word, or a number from 0 to 1."""

    name = "auto|exact|soft|0..1"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> str | float:
        """Return the word or the number; its range is checked with the other settings."""
        if value in get_args(HandlesName):
            return str(value)
        try:
            if "_" in str(value):  # Python would read 1_0 as a number
                raise ValueError
            return float(value)
        except ValueError:
            self.fail(f"expected auto, exact, soft or a number from 0 to 1, found '{value}'", param, ctx)


WEIGHTS = (
    click.option(
        "--weights",
        type=click.Choice(get_args(WeightsName)),
        help="Learned from the control points (neural), from the shape too, or the classic ones.  [default: neural]",
    ),
    click.option(
        "--temperature",
        type=float,
        help="Of the softmax: below 1 parts move more apart, above 1 more together.  [default: 1]",
    ),
    click.option("--alpha", type=float, help="Inverse-distance: exponent of the squared distance.  [default: 1]"),
    click.option(
        "--epsilon",
        type=float,
        help="Inverse-distance: above 0 caps the weight near a control point; "
        "distances count in halves of the longest side.  [default: 0]",
    ),
    click.option("--width", type=int, help="Neural: neurons of a hidden layer.  [default: 1024]"),
    click.option("--steps", type=int, help="Neural: steps of the training.  [default: until the loss is small]"),
    click.option("--seed", type=int, help="Neural, shape-aware: seed of the training.  [default: 0]"),
)
MOTION = (
    click.option(
        "--transform",
        type=click.Choice(get_args(Transform)),
        help="What may happen to the shape locally.  [default: rigid]",
    ),
    click.option(
        "--handles",
        type=HandlesType(),
        help="How closely control points arrive: all the way where they own their places and arrive (auto), at any "
        "price (exact), near their targets as in the paper (soft), or that part of the way.  [default: auto]",
    ),
    click.option(
        "--relax",
        type=float,
        help="How far the elastic finish goes, 0 (none) to 1: the shape's own stiffness decides what control points "
        "leave open.  [default: 0]",
    ),
    click.option(
        "--no-folds/--one-step",
        "no_folds",
        default=None,
        help="Fold nothing of the shape over: where one step does, take as many small ones as it needs.  "
        "[default: one step]",
    ),
)


def settings_options(*options: Callable[[Any], Any]) -> Callable[[Function], Function]:
    """Add options of settings; the function gets those that were said as `said`."""

    def decorate(function: Function) -> Function:
        @wraps(function)
        def chosen(**arguments: Any) -> Any:
            said = {name: arguments.pop(name) for name in names}
            return function(said={name: value for name, value in said.items() if value is not None}, **arguments)

        names: list[str] = []
        for option in reversed(options):
            chosen = option(chosen)
            names.append(chosen.__click_params__[-1].name)  # type: ignore[attr-defined]  # where Click keeps them
        return cast(Function, chosen)

    return decorate
