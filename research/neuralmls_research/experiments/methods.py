"""The methods that experiments compare, each under one name and with one way to call it.

>>> list(METHODS)
['neural', 'neural-exact', 'shape-aware', 'shape-aware-exact', 'classic', 'rbf', 'arap', 'biharmonic']
>>> square = Surface(np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]), np.array([[0, 1, 2], [0, 2, 3]]))
>>> METHODS["classic"](square, square.positions, square.positions + 1).tolist()[0]
[1.0, 1.0, 1.0]

A new method is one more entry of `METHODS`.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from neuralmls import Deformer, NeuralWeights, ShapeAwareWeights, Weights
from neuralmls.plugin import Transform
from neuralmls_research import baselines

Array: TypeAlias = NDArray[np.float64]
SpaceMap: TypeAlias = Callable[[Array], Array]

OURS = "(ours)"  # in the titles of what is not in the paper: docs/notes/beyond-the-paper.md


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
        What tables and figures call it.
    bind : callable, (shape, p (m, d)) -> Bound
        Does once, as training a network, what does not depend on the targets.
    """

    title: str
    bind: Callable[[Geometry, ArrayLike], Bound]

    def __call__(self, shape: Geometry, p: ArrayLike, q: ArrayLike) -> Array:
        """Return the vertices deformed, (n, d) float64, in the coordinates of the shape."""
        return self.bind(shape, p).positions(q)


def of_shapes(title: str, deformed: Callable[[Geometry, ArrayLike, ArrayLike], Array]) -> Method:
    """A method that is one function of `(shape, p, q)`, and looks at the shape as a whole."""
    return Method(title, lambda shape, p: Bound(lambda q: deformed(shape, p, q)))


def neural(
    title: str = "NeuralMLS",
    *,
    transform: Transform = "rigid",
    temperature: float = 1.0,
    adherence: float = 0.0,
    **training: Any,
) -> Method:
    """The paper's weights, with the options of `Deformer` and of `NeuralWeights.fit` (steps, width, seed, ...)."""

    def fitted(shape: Geometry, p: ArrayLike) -> Weights:
        bounds = np.stack([shape.positions.min(axis=0), shape.positions.max(axis=0)])
        return NeuralWeights.fit(p, bounds=bounds, **training)

    return _of_weights(title, fitted, transform, temperature, adherence)


def shape_aware(title: str = f"Shape-aware {OURS}", *, adherence: float = 0.0, seed: int = 0) -> Method:
    """Weights that know the shape, with the options of `Deformer.deform` and of `ShapeAwareWeights.fit`."""

    def fitted(shape: Geometry, p: ArrayLike) -> Weights:
        return ShapeAwareWeights.fit(p, shape.positions, shape.faces, seed=seed)

    return _of_weights(title, fitted, adherence=adherence)


def classic(title: str = baselines.TITLES["classic"], **options: Any) -> Method:
    """Inverse-distance weights with the options of `baselines.classic`; 1/d, as in the paper, unless told otherwise."""
    return _of_space(title, "classic", **{"alpha": 0.5, **options})


def kpd(path: str | os.PathLike[str], title: str = baselines.TITLES["kpd"]) -> Method:
    """KeypointDeformer with a network for the shape's category, from a `.safetensors` file.

    Raises
    ------
    FileError
        The file cannot be used.
    NeuralMLSError
        SciPy or safetensors is not installed.
    """
    from neuralmls_research.baselines.kpd import KeypointDeformer

    network = KeypointDeformer.read(path)

    def bind(shape: Geometry, p: ArrayLike) -> Bound:
        bound = network.bind(shape)
        return Bound(lambda q: baselines.get("kpd")(shape, p, q, network=bound))

    return Method(title, bind)


def _of_weights(
    title: str,
    fitted: Callable[[Geometry, ArrayLike], Weights],
    transform: Transform = "rigid",
    temperature: float = 1.0,
    adherence: float = 0.0,
) -> Method:
    """Moving least squares with weights that are fitted to the shape and its control points."""

    def bind(shape: Geometry, p: ArrayLike) -> Bound:
        weights = fitted(shape, p)

        def deformed(deformer: Deformer, q: ArrayLike) -> Array:
            return np.asarray(deformer.deform(q, temperature, adherence=adherence), dtype=np.float64)

        of_vertices = Deformer(shape.positions, weights, transform=transform)
        return Bound(
            lambda q: deformed(of_vertices, q),
            lambda q: lambda x: deformed(Deformer(x, weights, transform=transform), q),
        )

    return Method(title, bind)


def _of_space(title: str, name: str, **options: Any) -> Method:
    """A baseline that moves each point by where it is, whatever the shape."""

    def bind(shape: Geometry, p: ArrayLike) -> Bound:
        def space(q: ArrayLike) -> SpaceMap:
            return lambda x: baselines.get(name)(Surface(x, None), p, q, **options)

        return Bound(lambda q: space(q)(shape.positions), space)

    return Method(title, bind)


METHODS: dict[str, Method] = {
    "neural": neural(),
    "neural-exact": neural(f"NeuralMLS, exact {OURS}", adherence=1.0),
    "shape-aware": shape_aware(),
    "shape-aware-exact": shape_aware(f"Shape-aware, exact {OURS}", adherence=1.0),
    "classic": classic(),
    "rbf": _of_space(baselines.TITLES["rbf"], "rbf"),
    "arap": of_shapes(baselines.TITLES["arap"], baselines.get("arap")),
    "biharmonic": of_shapes(baselines.TITLES["biharmonic"], baselines.get("biharmonic")),
}
