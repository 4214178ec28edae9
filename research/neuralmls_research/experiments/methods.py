"""The methods that experiments compare, each under one name and with one way to call it.

>>> list(METHODS)[:5]
['neural', 'neural-exact', 'shape-aware', 'shape-aware-exact', 'classic']
>>> METHODS["classic"].title, neural(steps=48, temperature=0.5).title
('Classic MLS (alpha 0.5: 1/d)', 'NeuralMLS (48 steps, temperature 0.5)')
>>> square = Surface(np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]), np.array([[0, 1, 2], [0, 2, 3]]))
>>> METHODS["classic"](square, square.positions, square.positions + 1).tolist()[0]
[1.0, 1.0, 1.0]

A new method is one more entry of `METHODS`.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial
from typing import TYPE_CHECKING, Any, Protocol, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from neuralmls import ControlPoints, Map, Session
from neuralmls.errors import ArgumentError
from neuralmls.plugin import Transform
from neuralmls_research import baselines
from neuralmls_research.experiments.naming import OURS, own, settings_of, title_of

if TYPE_CHECKING:
    from neuralmls_research.baselines.kpd import KeypointDeformer

Array: TypeAlias = NDArray[np.float64]
SpaceMap: TypeAlias = Callable[[Array], Array]

__all__ = ["KPD", "METHODS", "OURS", "Array", "Bound", "Geometry", "Method", "Surface", "classic", "kpd", "neural",
           "of_shapes", "shape_aware", "with_settings"]  # fmt: skip

KPD = "keypoint-deformer"  # the name that people call it by: it needs weights, and is none of `METHODS`
PAPER_ALPHA = 0.5  # of the classic weights that the paper compares with: 1/d


class Geometry(Protocol):
    """What a method looks at of a shape: a `Shape`, or a `Surface` that was never in a file."""

    @property
    def positions(self) -> Array:
        """(n, d)."""

    @property
    def faces(self) -> NDArray[Any] | None:
        """(f, 3) integers; None for a point cloud."""


@dataclass(frozen=True)
class Surface:
    """Positions (n, d) and faces (f, 3) that were never in a file."""

    positions: Array
    faces: NDArray[Any] | None


@dataclass(frozen=True)
class Bound:
    """A method with a shape and its control points at rest, which it deforms for any targets q (m, d).

    Attributes
    ----------
    positions : callable, q -> (n, d)
        The vertices deformed. Raises `NotApplicable` where the method cannot do the shape, in a sentence.
    space : callable, q -> (callable, (k, d) -> (k, d)), or None
        The map of all of space whose values at the vertices `positions` are; None where there is none.
    """

    positions: Callable[[ArrayLike], Array]
    space: Callable[[ArrayLike], SpaceMap] | None = None


@dataclass(frozen=True)
class Method:
    """One way to deform a shape by control points; call it with `(shape, p, q)`.

    Attributes
    ----------
    title : str
        What tables and figures call it, with the parameters that are not left at their defaults.
    bind : callable, (shape, p (m, d)) -> Bound
        Does once, as training a network, what does not depend on the targets.
    settings : dict
        All of its settings, as a session has them; empty for a method that is no moving least squares.
    """

    title: str
    bind: Callable[[Geometry, ArrayLike], Bound]
    settings: Mapping[str, Any] = field(default_factory=dict)

    @property
    def seed(self) -> int | None:
        """The seed of its training; None where there is none, so that it always gives the same."""
        seed: int | None = self.settings.get("weights", {}).get("seed")
        return seed

    def __call__(self, shape: Geometry, p: ArrayLike, q: ArrayLike) -> Array:
        """Return the vertices deformed, (n, d) float64, in the coordinates of the shape."""
        return self.bind(shape, p).positions(q)


def of_shapes(title: str, deformed: Callable[[Geometry, ArrayLike, ArrayLike], Array]) -> Method:
    """A method that is one function of `(shape, p, q)`, and looks at the shape as a whole."""
    return Method(title, lambda shape, p: Bound(lambda q: deformed(shape, p, q)))


def neural(
    title: str | None = None,
    *,
    transform: Transform = "rigid",
    temperature: float = 1.0,
    adherence: float = 0.0,
    relax: float = 0.0,
    **training: Any,
) -> Method:
    """The paper's weights, with the options of `Session` and of `NeuralWeights.fit` (steps, width, seed, ...).

    Raises
    ------
    ArgumentError
        A setting is out of its range.
    """
    said = {"transform": transform, "temperature": temperature, "relax": relax, **training}
    return _of_session(title, settings_of("neural", adherence, **said))


def shape_aware(
    title: str | None = None,
    *,
    transform: Transform = "rigid",
    temperature: float = 1.0,
    adherence: float = 0.0,
    relax: float = 0.0,
    seed: int = 0,
) -> Method:
    """Weights that know the shape, with the options of `Session` and of `ShapeAwareWeights.fit`.

    Raises
    ------
    ArgumentError
        A setting is out of its range.
    """
    said = {"transform": transform, "temperature": temperature, "relax": relax, "seed": seed}
    return _of_session(title, settings_of("shape-aware", adherence, **said))


def classic(
    title: str | None = None,
    *,
    transform: Transform = "rigid",
    temperature: float = 1.0,
    alpha: float = PAPER_ALPHA,
    epsilon: float = 0.0,
) -> Method:
    """Inverse-distance weights with the options of `InverseDistanceWeights`; alpha 0.5, as in the paper, if not given.

    Raises
    ------
    ArgumentError
        A setting is out of its range.
    """
    settings = settings_of(
        "inverse-distance", transform=transform, temperature=temperature, alpha=alpha, epsilon=epsilon
    )
    return _of_session(title, settings)


def kpd(network: KeypointDeformer | str | os.PathLike[str], title: str = baselines.TITLES["kpd"]) -> Method:
    """KeypointDeformer with a network for the shape's category, or the `.safetensors` file of one.

    Raises
    ------
    FileError
        The file cannot be used.
    NeuralMLSError
        SciPy or safetensors is not installed.
    """
    from neuralmls_research.baselines.kpd import KeypointDeformer

    known = network if isinstance(network, KeypointDeformer) else KeypointDeformer.read(network)

    def bind(shape: Geometry, p: ArrayLike) -> Bound:
        bound = known.bind(shape)
        return Bound(lambda q: baselines.get("kpd")(shape, p, q, network=bound))

    return Method(title, bind)


def _of_session(title: str | None, settings: Mapping[str, Any]) -> Method:
    """A session with these settings, which is fitted to the shape."""
    said = {name: settings[name] for name in ("handles", "relax")} | own(settings)

    def bind(shape: Geometry, p: ArrayLike) -> Bound:
        session = Session(ControlPoints(p), weights=settings["weights"]["kind"], **said)
        map = session.fit(shape.positions, faces=shape.faces)
        of_vertices = map.bind(shape.positions)

        def moved(q: ArrayLike) -> Map:
            return map.moved(ControlPoints(p, q))

        def positions(q: ArrayLike) -> Array:
            return np.asarray(moved(q).frame(of_vertices)[0], dtype=np.float64)

        def space(q: ArrayLike) -> SpaceMap:
            map = moved(q)
            return lambda x: np.asarray(map.at(x), dtype=np.float64)

        return Bound(positions, space)

    return Method(title or title_of(settings), bind, settings)


def _of_space(name: str) -> Method:
    """A baseline that moves each point by where it is, whatever the shape."""

    def bind(shape: Geometry, p: ArrayLike) -> Bound:
        def space(q: ArrayLike) -> SpaceMap:
            return lambda x: baselines.get(name)(Surface(x, None), p, q)

        return Bound(lambda q: space(q)(shape.positions), space)

    return Method(baselines.TITLES[name], bind)


def _baseline(name: str) -> Method:
    return of_shapes(baselines.TITLES[name], baselines.get(name))


_MAKERS: dict[str, Callable[..., Method]] = {
    "neural": neural,
    "neural-exact": partial(neural, adherence=1.0),
    "shape-aware": shape_aware,
    "shape-aware-exact": partial(shape_aware, adherence=1.0),
    "classic": classic,
    "neural-relax": partial(neural, adherence=1.0, relax=1.0),
    "shape-aware-relax": partial(shape_aware, adherence=1.0, relax=1.0),
}

METHODS: dict[str, Method] = {name: maker() for name, maker in _MAKERS.items()} | {
    "rbf": _of_space("rbf"),
    "arap": _baseline("arap"),
    "arap-from-fit": of_shapes(
        f"{baselines.TITLES['arap']} from the rigid fit", partial(baselines.get("arap"), start="fit")
    ),
    "biharmonic": _baseline("biharmonic"),
    "biharmonic-displacements": _baseline("biharmonic-displacements"),
}


def with_settings(methods: Mapping[str, Method], said: Mapping[str, Any]) -> dict[str, Method]:
    """Return the methods with what a person said of them: each takes those of the settings that it has.

    Parameters
    ----------
    methods : dict of names, as in `METHODS`, to methods
    said : dict
        Settings by the names that sessions have for them: temperature, transform, alpha, steps, width, seed.

    Raises
    ------
    ArgumentError
        A setting is out of its range, or none of the methods has it.

    Examples
    --------
    >>> {name: method.title for name, method in with_settings(METHODS, {"alpha": 2.0}).items()}["classic"]
    'Classic MLS (alpha 2: 1/d^4)'
    """
    for setting in said:
        if not any(setting in own(method.settings) for method in methods.values()):
            raise ArgumentError(
                f"{setting}: none of the methods {', '.join(methods) or 'asked for'} has such a setting"
            )
    changed = dict(methods)
    for name, method in methods.items():
        before = own(method.settings)
        after = before | {setting: value for setting, value in said.items() if setting in before}
        if after != before:
            changed[name] = _MAKERS[name](**after)
    return changed
