"""What the commands that run methods are told of them. Sessions check it: the ranges and names are theirs."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import wraps
from typing import TYPE_CHECKING, Any, TypeVar, cast, get_args

import click

from neuralmls.errors import ArgumentError

if TYPE_CHECKING:
    from neuralmls import Session
    from neuralmls_research.experiments.methods import Method

Function = TypeVar("Function", bound=Callable[..., Any])

MOST_SEEDS = 1000


def options(alpha: float) -> Callable[[Function], Function]:
    """Add the options of settings; the function gets those that were said as `said`, and how many seeds as `seeds`."""
    from neuralmls.plugin import Transform

    added = (
        click.option("--temperature", type=float, help="Of the softmax of our methods and of classic.  [default: 1]"),
        click.option("--transform", type=click.Choice(get_args(Transform)), help="Of the same.  [default: rigid]"),
        click.option("--alpha", type=float, help=f"Classic: the weights are 1/d^(2 alpha).  [default: {alpha:g}]"),
        click.option("--width", type=int, help="Neural: neurons of a hidden layer.  [default: 1024]"),
        click.option("--steps", type=int, help="Neural: steps of the training."),
        click.option("--seed", type=int, help="Neural, shape-aware: seed of the training.  [default: 0]"),
        click.option(
            "--seeds", metavar="N", type=int, default=1, show_default=False,
            help="Train with N seeds, from --seed on: means, deviations, and what hangs on the seed.",
        ),
    )  # fmt: skip
    names = ("temperature", "transform", "alpha", "width", "steps", "seed")

    def decorate(function: Function) -> Function:
        @wraps(function)
        def chosen(**arguments: Any) -> Any:
            said = {name: arguments.pop(name) for name in names}
            if not 1 <= arguments["seeds"] <= MOST_SEEDS:
                raise ArgumentError(f"--seeds: expected 1 to {MOST_SEEDS}, found {arguments['seeds']}")
            return function(said={name: value for name, value in said.items() if value is not None}, **arguments)

        for option in reversed(added):
            chosen = option(chosen)
        return cast(Function, chosen)

    return decorate


def of_session(session: Session, methods: Mapping[str, Method]) -> dict[str, Method]:
    """The methods with what a session says: transform and temperature of all, the parameters of its kind of weights."""
    from neuralmls_research.experiments.methods import with_settings
    from neuralmls_research.experiments.naming import own

    if not session.has_settings:
        return dict(methods)
    changed = dict(methods)
    for name, method in methods.items():
        if method.settings:
            shared = {key: session.settings[key] for key in ("transform", "temperature")}
            same = method.settings["weights"]["kind"] == session.weights
            changed |= with_settings({name: method}, own(session.settings) if same else shared)
    return changed


def by_seed(methods: Mapping[str, Method], count: int) -> dict[str, list[Method]]:
    """Each method once for each of `count` seeds, from its own on; once where there is nothing random about it."""
    from neuralmls_research.experiments.methods import with_settings

    found = {}
    for name, method in methods.items():
        found[name] = [method]
        if method.seed is not None:
            others = range(method.seed + 1, method.seed + count)
            found[name] += [with_settings({name: method}, {"seed": seed})[name] for seed in others]
    return found
