"""Options that several commands have."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any, TypeVar

import click

from neuralmls.errors import ArgumentError

PATH = click.Path(path_type=Path)

Function = TypeVar("Function", bound=Callable[..., Any])
Decorator = Callable[[Function], Function]

force = click.option("--force", is_flag=True, help="Overwrite files that are there.")
json = click.option("--json", is_flag=True, help="As JSON, for machines.")
quiet = click.option("--quiet", "-q", is_flag=True, help="Say nothing, show no progress bar.")
shape = click.argument("shape", type=PATH)
shapes = click.argument("shapes", metavar="SHAPE...", type=PATH, nargs=-1, required=True)


def output(help: str) -> Decorator[Any]:
    """Return the option that names the file to write."""
    return click.option("--output", "-o", type=PATH, required=True, help=help)


def output_or_folder(help: str) -> Decorator[Any]:
    """Return the option that names the file or folder to write, as it was said: a / at its end makes it a folder."""
    return click.option("--output", "-o", type=click.Path(), required=True, help=help)


def points(help: str) -> Decorator[Any]:
    """Return the option that names the file of control points, which the command cannot do without."""
    return click.option("--points", type=PATH, required=True, help=help)


def session(function: Function) -> Function:
    """Add the options that name the files of control points."""
    for option in (
        click.option("--by-order", is_flag=True, help="Join the two files by order, whatever the names."),
        click.option("--targets", type=PATH, help="A second file: where the control points of the first go, by name."),
        click.option(
            "--points",
            type=PATH,
            help="The control points and their targets: a session, a CSV, or landmarks of another tool.",
        ),
    ):
        function = option(function)
    return function


def names(text: str, known: Iterable[str]) -> list[str]:
    """Return the names of `--methods NAME,...`.

    Raises
    ------
    ArgumentError
        One is none of the known ones.
    """
    found, expected = text.split(","), list(known)
    for name in found:
        if name not in expected:
            raise ArgumentError(f"--methods: expected names out of {', '.join(expected)}, found '{name}'")
    return found
