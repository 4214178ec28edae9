"""What methods are called: with their parameters, by the words that sessions have for them.

>>> title_of(settings_of("inverse-distance", alpha=1.0))
'Classic MLS (alpha 1: 1/d^2)'
>>> title_of(settings_of("shape-aware", 1.0, seed=3))
'Shape-aware, exact (seed 3) (ours)'
>>> title_of(settings_of("neural", 1.0, relax=1.0))
'NeuralMLS, exact, relax 1 (ours)'
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal

from neuralmls import ControlPoints, Session

OTHERS = ("kind", "weights", "handles", "relax", "no_folds")  # of a session, that methods are not varied by
Kind = Literal["neural", "shape-aware", "inverse-distance"]

OURS = "(ours)"  # in the titles of what is not in the paper: docs/notes/beyond-the-paper.md
TITLES: dict[str, str] = {"neural": "NeuralMLS", "shape-aware": "Shape-aware", "inverse-distance": "Classic MLS"}


def settings_of(kind: Kind, adherence: float = 0.0, **said: Any) -> dict[str, Any]:
    """Return all settings of moving least squares with weights of a kind, as a session file has them.

    Parameters
    ----------
    adherence : float, 0 to 1
        How much of the way to their targets the control points are taken beyond plain moving least squares.
    said : settings of `neuralmls.Session`; the others are at their defaults

    Raises
    ------
    ArgumentError
        A setting is out of its range, or belongs to other weights.
    """
    handles = {0.0: "soft", 1.0: "exact"}.get(adherence, adherence)
    return Session(ControlPoints([[0.0]]), weights=kind, handles=handles, **said).settings  # type: ignore[arg-type]


def own(settings: Mapping[str, Any]) -> dict[str, Any]:
    """Return the settings that a person may say, without nesting: the weights' own, transform, temperature.

    >>> own(settings_of("shape-aware"))
    {'seed': 0, 'transform': 'rigid', 'temperature': 1}
    """
    flat = {**settings.get("weights", {}), **settings}
    return {name: value for name, value in flat.items() if name not in OTHERS}


def title_of(settings: Mapping[str, Any]) -> str:
    """Return a method's title: what is not left at its default is in it, alpha always."""
    kind = settings["weights"]["kind"]
    defaults = own(settings_of(kind))
    said = {name: value for name, value in own(settings).items() if name == "alpha" or value != defaults[name]}
    title = TITLES[kind]
    if settings["handles"] != "soft":
        title += ", exact" if settings["handles"] == "exact" else f", handles {settings['handles']:g}"
    if settings["relax"]:
        title += f", relax {settings['relax']:g}"
    if said:
        title += f" ({', '.join(_said(name, value) for name, value in said.items())})"
    return title if kind != "shape-aware" and settings["handles"] == "soft" else f"{title} {OURS}"


def description_of(settings: Mapping[str, Any]) -> str:
    """Return all settings in words.

    >>> description_of(settings_of("inverse-distance", alpha=0.5))
    'alpha 0.5: 1/d, epsilon 0, rigid, temperature 1, handles soft'
    """
    said = [_said(name, value) for name, value in own(settings).items() if value is not None or name == "steps"]
    relax = [f"relax {settings['relax']:g}"] if settings["relax"] else []
    return ", ".join([*said, f"handles {settings['handles']}", *relax])


def _said(name: str, value: Any) -> str:
    if name == "alpha":
        return f"alpha {value:g}: {power(value)}"
    if name == "steps":
        return "steps until control points own their places" if value is None else f"{value} steps"
    return str(value) if name == "transform" else f"{name.replace('_', ' ')} {value:g}"


def power(alpha: float) -> str:
    """Return the classic weights of an alpha as they are written.

    >>> power(0.5), power(1.0), power(0.75)
    ('1/d', '1/d^2', '1/d^1.5')
    """
    return "1/d" if alpha == 0.5 else f"1/d^{2 * alpha:g}"
