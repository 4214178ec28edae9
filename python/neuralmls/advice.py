"""Honest advice: where a deformation is likely bad, and what would help.

The thresholds were set on the user study's chairs and airplanes (docs/beyond-the-paper.md), people's own
displacements, none of which looks torn: each lies well beyond what those cases reach.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from neuralmls.arrays import as_number, as_points, box_around
from neuralmls.deformer import Deformer
from neuralmls.errors import ArgumentError
from neuralmls.exact import ExactHandles
from neuralmls.metrics import beside, jacobians
from neuralmls.metrics.triangles import as_triangles
from neuralmls.placement import sample_faces
from neuralmls.protocol import Transform, Weights
from neuralmls.weights.softmax import softmax

Kind: TypeAlias = Literal["misses", "folds", "torn", "ungoverned"]
Array: TypeAlias = NDArray[np.float64]

# A handle may stop short by this part of the longest move (study: up to 0.075), an exact one by this part of the box.
SHORT, ARRIVED = 0.1, 1e-6
# Folds may have this part of the surface (study: 0 in 12 cases, 0.0003 and 0.011 in two, both true folds).
FOLDED = 0.002
# A stretch may be so many times that of most of the shape (study: up to 3.4)...
STRETCH = 5.0
# ... at this part of the surface: bands where weights switch are narrow.
TORN = 0.0005
# A place may be so many times farther from all control points than they are from each other (study: up to 0.83;
# points spread by farthest-point sampling: never above 1), if it moves by more than this part of the longest side.
FAR, MOVED = 1.5, 0.01
# Where it is looked for: so many places on the shape, and differences over this part of the longest side, so that
# a band too narrow for the places to lie in is still seen from its sides.
PLACES, STEP = 4000, 2.5e-3
# Everything moves as one if the Jacobians differ by no more.
ALIKE = 1e-6
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
    case = _Case(x, faces, weights, targets, transform, names)
    t = as_number("temperature", temperature, 0)
    found = case.misses(t, adherence)
    motion = case.motion(t, adherence)
    if not motion.alike():
        found += case.folds(t, adherence, motion) + case.torn(t, adherence, motion) + case.ungoverned(motion)
    return found


@dataclass(frozen=True)
class _Motion:
    """What a deformation does at the places: where they go (k, d), and the Jacobians there (k, d, d)."""

    positions: Array
    jacobians: Array

    def alike(self) -> bool:
        return bool(np.ptp(self.jacobians, axis=0).max() < ALIKE)

    def turned(self) -> Array:
        """The determinants, (k,)."""
        determinants: Array = np.linalg.det(self.jacobians)
        return determinants

    def stretch(self) -> Array:
        """The greatest stretch at each place, in that of most places if that is above 1, (k,)."""
        stretch = np.linalg.norm(self.jacobians, ord=2, axis=(1, 2))
        relative: Array = stretch / max(1.0, float(np.median(stretch)))
        return relative

    def folded_part(self) -> float:
        return float((self.turned() <= 0).mean())

    def torn_part(self) -> float:
        return float((self.stretch() > STRETCH).mean())


class _Case:
    """A shape, its control points and their targets, at which several settings are tried."""

    def __init__(
        self,
        x: ArrayLike,
        faces: ArrayLike | None,
        weights: Weights,
        targets: ArrayLike,
        transform: Transform,
        names: Sequence[str] | None,
    ) -> None:
        self._p = as_points("weights.control_points", weights.control_points)
        points = as_points("x", x, self._p.shape[1])
        if not len(points):
            raise ArgumentError("x: expected at least one point, found none")
        self._q = as_points("targets", targets, points.shape[1])
        self._names = [f"p{i + 1}" for i in range(len(self._p))] if names is None else list(names)
        if len(self._names) != len(self._p):
            raise ArgumentError(f"names: expected {len(self._p)} of them, found {len(self._names)}")
        self._weights, self._transform = weights, transform
        self._exact = ExactHandles(weights, transform=transform)
        self._side = 2 * box_around(points)[1]
        self._places = _places(points, faces)
        self._deformer = Deformer(self._places, weights, transform=transform)
        self._beside = [Deformer(place, weights, transform=transform) for place in beside(self._places, self._step)]

    @property
    def _step(self) -> float:
        return STEP * self._side

    def motion(self, temperature: float, adherence: float) -> _Motion:
        """What the deformation does."""
        aimed = self._exact.aim(self._q, temperature, adherence).targets
        values = [np.asarray(deformer.deform(aimed, temperature), np.float64) for deformer in self._beside]
        return _Motion(np.asarray(self._deformer.deform(aimed, temperature), np.float64), jacobians(values, self._step))

    def misses(self, temperature: float, adherence: float) -> list[Advice]:
        """Control points that stop short of their targets."""
        distance = self._missed(self._transform, temperature, adherence)
        longest = float(np.linalg.norm(self._q - self._p, axis=1).max())
        allowed = SHORT * longest if adherence == 0 else ARRIVED * self._side
        short = [int(i) for i in (-distance).argsort() if distance[i] > max(allowed, ARRIVED * self._side)]
        if not short:
            return []
        worst = short[0]
        listed = ", ".join(f"'{self._names[i]}' by {distance[i]:.3g}" for i in short[:LISTED])
        listed += f" and {len(short) - LISTED} more" if len(short) > LISTED else ""
        sentence = f"control points stop short of their targets, at adherence {adherence:g}: {listed}; "
        return [
            self._advice(
                "misses", sentence + self._reach(temperature, adherence), short, self._p[worst], distance[worst]
            )
        ]

    def _reach(self, temperature: float, adherence: float) -> str:
        """What takes the control points to their targets."""
        tried: list[tuple[str, Transform, float]] = [
            ("", self._transform, temperature),
            (f" at temperature {temperature / 2:g}", self._transform, temperature / 2),
            (" with the affine transform", "affine", temperature),
        ]
        for how, transform, t in tried[adherence == 1 :]:
            if self._missed(transform, t, 1.0).max() <= ARRIVED * self._side:
                return f"exact handles arrive{how}"
        return "even exact handles, a lower temperature or the affine transform do not take them there: move them less"

    def _missed(self, transform: Transform, temperature: float, adherence: float) -> Array:
        """How far each control point ends from its target, (m,)."""
        aimed = ExactHandles(self._weights, transform=transform).aim(self._q, temperature, adherence).targets
        arrived = Deformer(self._p, self._weights, transform=transform).deform(aimed, temperature)
        return np.asarray(np.linalg.norm(arrived - self._q, axis=1))

    def folds(self, temperature: float, adherence: float, motion: _Motion) -> list[Advice]:
        """Places where space is turned inside out."""
        part = motion.folded_part()
        if part <= FOLDED:
            return []
        worst = int(motion.turned().argmin())
        near = self._governing(worst, temperature)[:1]
        sentence = (
            f"{_percent(part)} of the shape is folded over, most of all near '{self._names[near[0]]}', at "
            f"{_at(self._places[worst])}; "
        )
        help = self._better(_Motion.folded_part, part, temperature, adherence)
        sentence += help or "move the control points there less far towards or past each other"
        return [self._advice("folds", sentence, near, self._places[worst], part)]

    def torn(self, temperature: float, adherence: float, motion: _Motion) -> list[Advice]:
        """Places where weights switch between control points that move apart."""
        part, stretch = motion.torn_part(), motion.stretch()
        if part <= TORN:
            return []
        worst = int(stretch.argmax())
        near = self._governing(worst, temperature)[:2]
        sentence = (
            f"the shape is torn between '{self._names[near[0]]}' and '{self._names[near[-1]]}', stretched up to "
            f"{stretch[worst]:.0f} times at {_at(self._places[worst])}; "
        )
        help = self._better(_Motion.torn_part, part, temperature, adherence)
        sentence += help or "move them less far apart, or put control points between them"
        return [self._advice("torn", sentence, near, self._places[worst], stretch[worst])]

    def ungoverned(self, motion: _Motion) -> list[Advice]:
        """A part that moves, and is far from all control points."""
        if len(self._p) < 2:
            return []
        distance, nearest = _nearest(self._places, self._p)
        spacing = float(np.median([_nearest(p[None], np.delete(self._p, i, 0))[0] for i, p in enumerate(self._p)]))
        moves = np.linalg.norm(motion.positions - self._places, axis=1) > MOVED * self._side
        distance = np.where(moves, distance, 0.0)
        worst = int(distance.argmax())
        if distance[worst] <= FAR * spacing:
            return []
        near = int(nearest[worst])
        sentence = (
            f"no control point governs the part around {_at(self._places[worst])}, which moves all the same: the "
            f"nearest, '{self._names[near]}', is {distance[worst]:.3g} away, {distance[worst] / spacing:.1f} times as "
            "far as they are from each other; put a control point there"
        )
        return [self._advice("ungoverned", sentence, [near], self._places[worst], distance[worst])]

    def _better(self, part: Callable[[_Motion], float], now: float, temperature: float, adherence: float) -> str:
        """Which other setting at least halves a part of the shape, if one does."""
        others = [t for t in (1.0, temperature / 2, temperature * 2) if t != temperature]
        tried = [(t, adherence, f"at temperature {t:g}") for t in others]
        if adherence > 0:
            tried.append((temperature, 0.0, "without exact handles"))
        parts = [part(self.motion(t, a)) for t, a, _ in tried]
        best = int(np.argmin(parts))
        return f"{tried[best][2]} it is {_percent(parts[best])}" if parts[best] <= now / 2 else ""

    def _governing(self, place: int, temperature: float) -> list[int]:
        """The control points by their weight at a place, the heaviest first."""
        weights = softmax(self._weights.logits(self._places[place : place + 1]), temperature)[0]
        return [int(i) for i in (-weights).argsort(kind="stable")]

    def _advice(self, kind: Kind, sentence: str, near: list[int], where: Array, amount: float) -> Advice:
        return Advice(kind, sentence, tuple(where.tolist()), tuple(self._names[i] for i in near), float(amount))


def _places(x: Array, faces: ArrayLike | None) -> Array:
    """Places to look at (k, d): on the surface by area, or points of the cloud."""
    rng = np.random.default_rng(0)
    if faces is not None and np.size(faces):
        origin = (x.min(axis=0) + x.max(axis=0)) / 2  # samples keep their digits far from the origin
        _, samples = sample_faces(x - origin, as_triangles(faces, len(x)), PLACES, rng)
        if len(samples):
            places: Array = samples + origin
            return places
    return x if len(x) <= PLACES else x[np.sort(rng.permutation(len(x))[:PLACES])]


def _nearest(x: Array, p: Array) -> tuple[Array, NDArray[np.int64]]:
    """The distance to the nearest of the points `p`, and which it is, for each of `x`."""
    distances = np.stack([np.linalg.norm(x - point, axis=1) for point in p])
    return distances.min(axis=0), distances.argmin(axis=0)


def _at(place: Array) -> str:
    return "(" + ", ".join(f"{value:.4g}" for value in place) + ")"


def _percent(part: float) -> str:
    return f"{100 * part:.2g} %"
