"""Settings that a session of the editor carries beside its control points: what was set there holds here too."""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, get_args

import click
from click.core import ParameterSource

from neuralmls.arrays import as_number
from neuralmls.cli.weights import PARAMETERS, Kind, WeightsChoice
from neuralmls.control_point_files import read_text
from neuralmls.errors import ArgumentError, FileError
from neuralmls.protocol import Transform

# What the editor calls the weights; their parameters are under the same name.
KINDS: dict[str, Kind] = {"neural": "neural", "classic": "inverse-distance"}


@dataclass(frozen=True)
class Settings:
    """How to deform: as the person said, else as the session has it, else the defaults.

    Attributes
    ----------
    adherence : float, 0 to 1
        How far control points are taken from where plain moving least squares takes them towards their targets.
    careful : bool
        Whether control points that this would harm are left soft, and none ever jumps.
    session : str or None
        The file that the settings are from.
    """

    choice: WeightsChoice
    temperature: float
    transform: Transform
    adherence: float = 1.0
    careful: bool = True
    session: str | None = None


def with_session(given: Settings, points: Path) -> Settings:
    """Return the running command's settings, completed by those of the session in `points`, a control-point file.

    Raises
    ------
    FileError
        A setting of the session is not what the editor writes; the message names it.
    """
    document = json.loads(read_text(points)) if points.suffix.lower() == ".json" else {}
    found = _record(_record(document.get("editor")).get("settings"))
    if not found:
        return given
    context = click.get_current_context()
    open_ = {name for name in context.params if context.get_parameter_source(name) == ParameterSource.DEFAULT}
    try:
        known = {
            "temperature": as_number("temperature", found.get("temperature", 1.0), 0),
            "transform": _one_of("transform", found.get("transform", "rigid"), get_args(Transform)),
        }
        adherence = as_number("adherence", found.get("adherence", 1.0), 0, 1, open_low=False)
        return replace(
            given,
            choice=_choice(given.choice, found, open_),
            adherence=adherence if "exact" in open_ else given.adherence,
            session=str(points),
            **{name: value for name, value in known.items() if name in open_},
        )
    except ArgumentError as error:
        raise FileError(f"{points}: editor.settings: {error}") from None


def _choice(choice: WeightsChoice, found: dict[str, Any], open_: set[str]) -> WeightsChoice:
    name = _one_of("kind", found.get("kind", "neural"), KINDS)
    if "weights" in open_:
        choice = replace(choice, kind=KINDS[name])
    elif choice.kind != KINDS[name]:
        return choice
    parameters = _record(found.get(name)).items()
    choice = replace(choice, **{key: v for key, v in parameters if key in open_ and key in PARAMETERS[choice.kind]})
    choice.check()
    return choice


def _one_of(name: str, value: Any, known: Iterable[str]) -> Any:
    if value not in list(known):
        raise ArgumentError(f"{name}: expected {' or '.join(known)}, found {value!r}")
    return value


def _record(value: Any) -> dict[str, Any]:
    return value if isinstance(value, dict) else {}
