"""Honest advice: where a deformation is likely bad, and what would help.

What is measured, and from when on it is told, stands in crates/core/src/advice.rs, which the editor has it from too.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, TypeAlias, cast

import numpy as np
from numpy.typing import ArrayLike

from neuralmls.arrays import as_number
from neuralmls.errors import ArgumentError, NeuralMLSError
from neuralmls.probe import Array, Probe
from neuralmls.protocol import Transform, Weights
from neuralmls.turns import Rotations, Scales
from neuralmls.weights import ShapeAwareWeights

Kind: TypeAlias = Literal["misses", "folds", "torn", "ungoverned"]

# A soft handle may stop short by this part of the longest move (study: up to 0.075), and of the longest side (0.011);
# an exact one by this part of the side.
SHORT, WIDE, ARRIVED = 0.1, 0.02, 1e-6
LISTED = 5


@dataclass(frozen=True)
class Advice:
    """One thing that is likely bad about a deformation.

    Attributes
    ----------
    kind : "misses", "folds", "torn" or "ungoverned"
    sentence : str
        What is likely bad, where, and what would help.
    where : tuple of d floats
        The worst place, at rest.
    control_points : tuple of str
        The names of those that it is about, the worst first.
    amount : float
        How bad: the greatest distance from a target (misses), the part of the shape (folds), the greatest stretch
        (torn), the distance to the nearest control point (ungoverned).
    """

    kind: Kind
    sentence: str
    where: tuple[float, ...]
    control_points: tuple[str, ...]
    amount: float


def advise(
    x: ArrayLike,
    faces: ArrayLike | None,
    weights: Weights,
    targets: ArrayLike,
    *,
    transform: Transform = "rigid",
    temperature: float = 1.0,
    adherence: float = 0.0,
    rotations: Rotations = None,
    scales: Scales = None,
    careful: bool = False,
    names: Sequence[str] | None = None,
) -> list[Advice]:
    """Return what is likely bad about a deformation, and what would help; nothing where all control points stay or
    move rigidly.

    - misses: control points that stop short of their targets;
    - folds: places where space is turned inside out, `det J <= 0`, with `J` the Jacobian of the deformation;
    - torn: places where `J` stretches far more than in most places, as between control points that move apart;
    - ungoverned: a part that moves, and is far from all control points.

    What would help was tried: another temperature, soft handles and, where neither does, shape-aware weights (if SciPy
    is there) are named only where they at least halve it; exact handles only where they arrive.

    Parameters
    ----------
    x : (n, d)
        The shape's points at rest, in any units.
    faces : (f, 3) integers, or None for a point cloud
        With them places are looked at by area, otherwise the points themselves.
    weights : Weights
        The weight function of the control points, in the units of `x`.
    targets : (m, d)
    transform, temperature, adherence, rotations, scales
        As `Deformer` has them.
    careful : bool
        Whether the control points go as `ExactHandles.aim_carefully` takes them, and `neuralmls deform`.
    names : sequence of m str, optional
        What to call the control points; p1, p2, ... if not given.

    Raises
    ------
    ArgumentError
        There are no points, or an argument does not fit another.

    Examples
    --------
    >>> from neuralmls import InverseDistanceWeights
    >>> x = np.linspace(0, 1, 21)[:, None]
    >>> weights = InverseDistanceWeights([[0.0], [0.4], [0.6], [1.0]])
    >>> advise(x, None, weights, weights.control_points + 1)
    []
    >>> [advice.kind for advice in advise(x, None, weights, [[0.0], [0.7], [0.3], [1.0]])]
    ['folds']
    """
    probe = Probe(x, faces, weights, targets, transform, rotations=rotations, scales=scales, careful=careful)
    named = tuple(f"p{i + 1}" for i in range(len(probe.p))) if names is None else tuple(names)
    if len(named) != len(probe.p):
        raise ArgumentError(f"names: expected {len(probe.p)} of them, found {len(named)}")
    setting = _Setting(as_number("temperature", temperature, 0), adherence)
    misses = _misses(probe, named, setting)
    found = [] if misses is None else [misses]
    for kind, amount, place, near, better in probe.core.advise(probe.q, probe.turns, setting.temperature, adherence):
        at = probe.places[place]
        if kind == "ungoverned":
            away = float(np.linalg.norm(at - probe.p[near[0]]))
            found.append(
                _advice("ungoverned", _ungoverned(named[near[0]], at, away, amount), named, near[:1], at, away)
            )
            continue
        help = _better(better) or _shape_aware(probe, setting, kind)
        if kind == "folds":
            help = help or "move the control points there less far towards or past each other"
            sentence = (
                f"{_percent(amount)} of the shape is folded over, most of all near '{named[near[0]]}', at {_at(at)}; "
            )
        else:
            help = help or "move them less far apart, or put control points between them"
            sentence = (
                f"the shape is torn between '{named[near[0]]}' and '{named[near[1]]}', stretched up to {amount:.0f} "
                f"times at {_at(at)}; "
            )
        near = near if kind == "torn" else near[:1]
        found.append(_advice(cast(Kind, kind), sentence + help, named, near, at, amount))
    return found


@dataclass(frozen=True)
class _Setting:
    """What a person can change without moving anything."""

    temperature: float
    adherence: float


def _misses(probe: Probe, names: tuple[str, ...], setting: _Setting) -> Advice | None:
    """Control points that stop short of their targets."""
    distance = probe.missed(setting.temperature, setting.adherence)
    longest = float(np.linalg.norm(probe.q - probe.p, axis=1).max())
    allowed = ARRIVED * probe.side
    if setting.adherence == 0:
        allowed = max(allowed, min(SHORT * longest, WIDE * probe.side))
    short = [int(i) for i in (-distance).argsort() if distance[i] > allowed]
    if not short:
        return None
    listed = ", ".join(f"'{names[i]}' by {distance[i]:.3g}" for i in short[:LISTED])
    listed += f" and {len(short) - LISTED} more" if len(short) > LISTED else ""
    sentence = f"control points stop short of their targets, at adherence {setting.adherence:g}: {listed}; "
    sentence += _what_arrives(probe, setting)
    return _advice("misses", sentence, names, short, probe.p[short[0]], distance[short[0]])


def _what_arrives(probe: Probe, setting: _Setting) -> str:
    """What takes the control points to their targets."""
    if probe.exact.aim_carefully(probe.q, setting.temperature, **probe.carried).soft is None:
        return "exact handles arrive"
    remedy = probe.exact.remedy(probe.q, setting.temperature, **probe.carried)
    if remedy is not None:
        return f"exact handles arrive {remedy}"
    return "even exact handles, a lower temperature or the affine transform do not take them there: move them less"


def _ungoverned(name: str, place: Array, away: float, spacings: float) -> str:
    """A part that moves, and is far from all control points."""
    return (
        f"no control point governs the part around {_at(place)}, which moves all the same: the nearest, '{name}', is "
        f"{away:.3g} away, {spacings:.1f} times as far as they are from each other; put a control point there"
    )


def _better(found: tuple[float | None, float] | None) -> str:
    """What the core has found to at least halve it, in words."""
    if found is None:
        return ""
    temperature, part = found
    how = "without exact handles" if temperature is None else f"at temperature {temperature:g}"
    return f"{how} it is {_percent(part)}"


def _shape_aware(probe: Probe, setting: _Setting, kind: str) -> str:
    """Whether weights that know the shape at least halve what is folded or torn, in words; nothing if not."""
    if isinstance(probe.weights, ShapeAwareWeights) or probe.p.shape[1] == 1:
        return ""
    try:
        weights = ShapeAwareWeights.fit(probe.p, probe.x, probe.faces)
    except NeuralMLSError:  # no SciPy, or no size to measure by
        return ""
    other = Probe(probe.x, probe.faces, weights, probe.q, probe.transform, **probe.carried, careful=probe.careful)
    now, then = (
        each.core.parts(each.q, each.turns, setting.temperature, setting.adherence)[kind == "torn"]
        for each in (probe, other)
    )
    return f"with shape-aware weights it is {_percent(then)}" if then <= now / 2 else ""


def _advice(kind: Kind, sentence: str, names: tuple[str, ...], near: list[int], where: Array, amount: float) -> Advice:
    return Advice(kind, sentence, tuple(where.tolist()), tuple(names[i] for i in near), float(amount))


def _at(place: Array) -> str:
    return "(" + ", ".join(f"{value:.4g}" for value in place) + ")"


def _percent(part: float) -> str:
    return f"{100 * part:.2g} %"
