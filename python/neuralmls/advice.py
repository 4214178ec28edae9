"""Honest advice: where a deformation is likely bad, and what would help.

The thresholds were set on what people did to the chairs and airplanes of the paper's user study, none of which looks
torn: each lies beyond what those cases reach (studies/advice_thresholds.py, docs/beyond-the-paper.md).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from neuralmls.arrays import as_number
from neuralmls.errors import ArgumentError
from neuralmls.probe import Array, Motion, Probe
from neuralmls.protocol import Transform, Weights

Kind: TypeAlias = Literal["misses", "folds", "torn", "ungoverned"]

# A soft handle may stop short by this part of the longest move (study: up to 0.075), and of the longest side (0.011);
# an exact one by this part of the side.
SHORT, WIDE, ARRIVED = 0.1, 0.02, 1e-6
# This part of the shape may be folded (study: 0.0003 at most, but for one true fold of 0.003 to 0.011).
FOLDED = 0.002
# This part may be stretched beyond `probe.STRETCH` (study: none, 3.3 at most): bands where weights switch are thin.
TORN = 0.0005
# A place may be so many spacings away from all control points (study: up to 0.83; points spread by farthest-point
# sampling: about 1 at most), if it moves by more than this part of the longest side.
FAR, MOVED = 1.5, 0.01
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
    names: Sequence[str] | None = None,
) -> list[Advice]:
    """Return what is likely bad about a deformation, and what would help; nothing where all control points stay or
    move rigidly.

    - misses: control points that stop short of their targets;
    - folds: places where space is turned inside out, `det J <= 0`, with `J` the Jacobian of the deformation;
    - torn: places where `J` stretches far more than in most places, as between control points that move apart;
    - ungoverned: a part that moves, and is far from all control points.

    What would help was tried: another temperature or exact handles are named only where they at least halve it.

    Parameters
    ----------
    x : (n, d)
        The shape's points at rest, in any units.
    faces : (f, 3) integers, or None for a point cloud
        With them places are looked at by area, otherwise the points themselves.
    weights : Weights
        The weight function of the control points, in the units of `x`.
    targets : (m, d)
    transform, temperature, adherence
        As `Deformer` has them.
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
    probe = Probe(x, faces, weights, targets, transform)
    named = tuple(f"p{i + 1}" for i in range(len(probe.p))) if names is None else tuple(names)
    if len(named) != len(probe.p):
        raise ArgumentError(f"names: expected {len(probe.p)} of them, found {len(named)}")
    setting = _Setting(as_number("temperature", temperature, 0), adherence)
    found = [_misses(probe, named, setting)]
    motion = probe.motion(temperature, adherence)
    if not motion.alike():
        found += [look(probe, named, setting, motion) for look in (_folds, _torn, _ungoverned)]
    return [advice for advice in found if advice is not None]


@dataclass(frozen=True)
class _Setting:
    """What a person can change without moving anything."""

    temperature: float
    adherence: float


def _misses(probe: Probe, names: tuple[str, ...], setting: _Setting) -> Advice | None:
    """Control points that stop short of their targets."""
    distance = probe.missed(probe.transform, setting.temperature, setting.adherence)
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
    if probe.exact.aim_carefully(probe.q, setting.temperature).soft is None:
        return "exact handles arrive"
    remedy = probe.exact.remedy(probe.q, setting.temperature)
    if remedy is not None:
        return f"exact handles arrive {remedy}"
    return "even exact handles, a lower temperature or the affine transform do not take them there: move them less"


def _folds(probe: Probe, names: tuple[str, ...], setting: _Setting, motion: Motion) -> Advice | None:
    """Places where space is turned inside out."""
    part = motion.folded_part()
    if part <= FOLDED:
        return None
    worst = int(motion.turned().argmin())
    near = _governing(probe, worst, setting)[:1]
    sentence = (
        f"{_percent(part)} of the shape is folded over, most of all near '{names[near[0]]}', at "
        f"{_at(probe.places[worst])}; "
    )
    help = _better(probe, setting, Motion.folded_part, part)
    sentence += help or "move the control points there less far towards or past each other"
    return _advice("folds", sentence, names, near, probe.places[worst], part)


def _torn(probe: Probe, names: tuple[str, ...], setting: _Setting, motion: Motion) -> Advice | None:
    """Places where weights switch between control points that move apart."""
    part, stretch = motion.torn_part(), motion.stretch()
    if part <= TORN:
        return None
    worst = int(stretch.argmax())
    near = _governing(probe, worst, setting)[:2]
    sentence = (
        f"the shape is torn between '{names[near[0]]}' and '{names[near[-1]]}', stretched up to "
        f"{stretch[worst]:.0f} times at {_at(probe.places[worst])}; "
    )
    help = _better(probe, setting, Motion.torn_part, part)
    sentence += help or "move them less far apart, or put control points between them"
    return _advice("torn", sentence, names, near, probe.places[worst], stretch[worst])


def _ungoverned(probe: Probe, names: tuple[str, ...], _: _Setting, motion: Motion) -> Advice | None:
    """A part that moves, and is far from all control points."""
    far, nearest = probe.far()
    moves = np.linalg.norm(motion.positions - probe.places, axis=1) > MOVED * probe.side
    worst = int(np.where(moves, far, 0.0).argmax())
    if not moves[worst] or far[worst] <= FAR:
        return None
    near, place = int(nearest[worst]), probe.places[worst]
    distance = float(np.linalg.norm(place - probe.p[near]))
    sentence = (
        f"no control point governs the part around {_at(place)}, which moves all the same: the nearest, "
        f"'{names[near]}', is {distance:.3g} away, {far[worst]:.1f} times as far as they are from each other; "
        "put a control point there"
    )
    return _advice("ungoverned", sentence, names, [near], place, distance)


def _better(probe: Probe, setting: _Setting, part: Callable[[Motion], float], now: float) -> str:
    """Which other setting at least halves a part of the shape, if one does."""
    t, adherence = setting.temperature, setting.adherence
    tried = [(other, adherence, f"at temperature {other:g}") for other in (1.0, t / 2, t * 2) if other != t]
    if adherence > 0:
        tried.append((t, 0.0, "without exact handles"))
    parts = [part(probe.motion(other, a)) for other, a, _ in tried]
    best = int(np.argmin(parts))
    return f"{tried[best][2]} it is {_percent(parts[best])}" if parts[best] <= now / 2 else ""


def _governing(probe: Probe, place: int, setting: _Setting) -> list[int]:
    """The control points by their weight at a place, the heaviest first."""
    return [int(i) for i in (-probe.weight(place, setting.temperature)).argsort(kind="stable")]


def _advice(kind: Kind, sentence: str, names: tuple[str, ...], near: list[int], where: Array, amount: float) -> Advice:
    return Advice(kind, sentence, tuple(where.tolist()), tuple(names[i] for i in near), float(amount))


def _at(place: Array) -> str:
    return "(" + ", ".join(f"{value:.4g}" for value in place) + ")"


def _percent(part: float) -> str:
    return f"{100 * part:.2g} %"
