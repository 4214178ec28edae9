"""Sessions: control points, settings, and the box in which weights are trained. Fitted, a session is a map of space."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable
from typing import Any, Literal, Self, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from neuralmls import _core
from neuralmls.arrays import Progress, as_box, as_points, as_triangles, box_around
from neuralmls.control_points import ControlPoints
from neuralmls.errors import ArgumentError, ControlPointError, FileError
from neuralmls.files import as_path, read_bytes, write_atomically
from neuralmls.handles import Transform
from neuralmls.map import Map
from neuralmls.shape import Shape
from neuralmls.weights import ShapeAwareWeights

WeightsName: TypeAlias = Literal["neural", "shape-aware", "inverse-distance"]
Handles: TypeAlias = Literal["auto", "exact", "soft"] | float

PARAMETERS = ("width", "steps", "seed", "rate", "fourier_sigma", "alpha", "epsilon")


class Session:
    """Control points and how the shape is to follow them: what the editor keeps, and what `neuralmls deform` reads.

    Parameters
    ----------
    points : ControlPoints
    weights : "neural", "shape-aware" or "inverse-distance"
    transform : "rigid", "similarity" or "affine"
    temperature : float > 0
    handles : "auto", "exact", "soft", or a number from 0 to 1
        How closely control points arrive at their targets. Auto: all the way where they own their places, as far as
        they go without a jump elsewhere. Exact: all the way, at any price. Soft: where plain moving least squares takes
        them, as in the paper. A number: that part of the way from soft to auto.
    frame : (2, d), optional
        The box in which weights are trained; without it, that of the shapes of `fit`. With it, one session is one map
        of space, whatever it is applied to.
    width, steps, seed, rate, fourier_sigma, alpha, epsilon : optional
        Parameters of the weights (see `NeuralWeights.fit`, `ShapeAwareWeights.fit`, `InverseDistanceWeights`).

    Raises
    ------
    ArgumentError
        A setting is out of its range, or belongs to other weights.

    Examples
    --------
    >>> points = ControlPoints([[0.0, 0], [1, 0]], targets=[[0.0, 0], [0, 1]])
    >>> map = Session(points, weights="inverse-distance").fit()
    >>> map.at([[0.5, 0.0]]).round(6).tolist()                 # half of the way, turned by a quarter
    [[0.0, 0.5]]
    """

    def __init__(
        self,
        points: ControlPoints,
        *,
        weights: WeightsName = "neural",
        transform: Transform = "rigid",
        temperature: float = 1.0,
        handles: Handles = "auto",
        frame: ArrayLike | None = None,
        **parameters: float | None,
    ) -> None:
        if not isinstance(points, ControlPoints):
            raise ArgumentError(f"points: expected ControlPoints, found {points!r}")
        said = {"weights": weights, "transform": transform, "temperature": temperature, "handles": handles}
        for name, value in said.items():
            if value is None:
                raise ArgumentError(f"{name}: expected a setting, found None")
        del said["weights"]
        changes = _settings(weights, parameters, **said)
        self._core = _core.Session(points._core).with_settings(changes)
        self._notes: tuple[str, ...] = ()
        if frame is not None:
            self._core = self._core.with_frame(as_box(frame, points.dimension))

    @classmethod
    def _of(cls, core: _core.Session, notes: Iterable[str] = ()) -> Self:
        self = cls.__new__(cls)
        self._core, self._notes = core, tuple(notes)
        return self

    @classmethod
    def read(
        cls,
        path: str | os.PathLike[str],
        targets: str | os.PathLike[str] | None = None,
        *,
        by_order: bool = False,
    ) -> Self:
        """Read control points of any kind: a session, a list of landmarks, files of other tools (docs/control-points.md).

        Parameters
        ----------
        path : a file, or - for standard input
        targets : a second file, optional
            Where the control points go, if `path` has only where they are; joined by name.
        by_order : bool
            Join the two files line by line, whatever the names.

        Raises
        ------
        FileError
            A file is missing, or is not what it says it is; the message names the line or the JSON path.
        ControlPointError
            The file is well-formed, but its control points cannot be used.
        """
        read = _read(path)
        if targets is not None:
            other = _read(targets)
            try:
                read = read.joined(other, by_order)
            except (FileError, ControlPointError, ArgumentError) as error:
                raise type(error)(f"{path} and {targets}: {error}") from None
        return cls._of(read.session, read.notes)

    def write(self, path: str | os.PathLike[str]) -> None:
        """Write a session file (JSON), or the control points alone (CSV), by the ending; keys of others are kept.

        Raises
        ------
        FileError
            The ending is another one, or that of a CSV file, which holds no orientations, and there are some; or the
            file cannot be written; a file that was there is then untouched.
        """
        ending = as_path("path", path).suffix.lower()
        if ending not in (".json", ".csv"):
            raise FileError(f"{path}: expected a control-point file that ends in .json or .csv")
        try:
            text = self._core.to_json() if ending == ".json" else self._core.to_csv()
        except FileError as error:
            raise FileError(f"{path}: {error}") from None
        write_atomically(path, text.encode())

    @property
    def points(self) -> ControlPoints:
        """The control points."""
        return ControlPoints._of(self._core.points)

    @property
    def notes(self) -> tuple[str, ...]:
        """What reading its file left out, a sentence each."""
        return self._notes

    @property
    def settings(self) -> dict[str, Any]:
        """The settings, as the session file has them: weights with their parameters, transform, temperature, handles."""
        found: dict[str, Any] = json.loads(self._core.settings)
        return found

    @property
    def has_settings(self) -> bool:
        """Whether its file said any, and they are not all left at their defaults."""
        return self._core.has_settings

    @property
    def weights(self) -> WeightsName:
        """The kind of its weights."""
        kind: WeightsName = self.settings["weights"]["kind"]
        return kind

    @property
    def frame(self) -> NDArray[np.float64] | None:
        """The box in which weights are trained, (2, d); None: that of the shapes of `fit`."""
        return self._core.frame

    def replace(
        self,
        *,
        points: ControlPoints | None = None,
        weights: WeightsName | None = None,
        transform: Transform | None = None,
        temperature: float | None = None,
        handles: Handles | None = None,
        frame: ArrayLike | None = None,
        **parameters: float | None,
    ) -> Session:
        """Return the same session with other control points, settings, frame; weights of another kind start anew.

        Raises
        ------
        ArgumentError
            A setting is out of its range, or belongs to other weights.
        """
        core = self._core if points is None else self._core.with_points(points._core)
        said = {"transform": transform, "temperature": temperature, "handles": handles}
        changes = _settings(weights, parameters, **{key: value for key, value in said.items() if value is not None})
        if changes != "{}":
            core = core.with_settings(changes)
        if frame is not None:
            core = core.with_frame(as_box(frame, self.points.dimension))
        return Session._of(core, self._notes)

    def fit(self, *shapes: Shape | ArrayLike, progress: Progress | None = None) -> Map:
        """Fit the weights to the control points: the map that `neuralmls deform` applies to these shapes.

        Parameters
        ----------
        shapes : Shape, or points (n, d)
            What it is for: the weights are trained in the box around all of them, unless the session has its own frame;
            shape-aware weights learn from all of them. Without any, in the box of the control points.
        progress : callable, optional
            Told the fraction done, from 0 to 1; what it raises stops the training.

        Raises
        ------
        ArgumentError
            The shapes have another dimension, or no size; shape-aware weights without a shape.
        NeuralMLSError
            Shape-aware weights need SciPy, and it is not installed.
        """
        dimension = self.points.dimension
        boxes = [shape.bounds if isinstance(shape, Shape) else _box(shape, dimension) for shape in shapes]
        bounds = as_box(box_around(np.concatenate(boxes)), dimension) if boxes else None
        if self.weights != "shape-aware":
            return Map._of(self._core.fit(bounds, progress))
        if bounds is None:
            raise ArgumentError("shapes: shape-aware weights need at least one shape to learn from")
        frame = self.frame if self.frame is not None else bounds
        x, faces = _together(shapes, dimension)
        seed = self.settings["weights"]["seed"]
        weights = ShapeAwareWeights.fit(
            self.points.sources, x, faces, bounds=frame, seed=seed, progress=progress
        )
        return Map._of(_core.Map.of(self._core.with_frame(np.ascontiguousarray(frame)), weights._core))

    def __reduce__(self) -> tuple[Any, ...]:
        return _restored, (self._core.to_json(), self._notes)


def _restored(text: str, notes: tuple[str, ...]) -> Session:
    return Session._of(_core.Read(text.encode(), "session.json").session, notes)


def _read(path: str | os.PathLike[str]) -> _core.Read:
    source = as_path("path", path)
    try:
        data = read_bytes(source)
    except FileNotFoundError as error:
        raise FileError(f"{path}: there is no such file") from error
    except OSError as error:
        raise FileError(f"{path}: cannot read: {error.strerror or error}") from error
    try:
        return _core.Read(data, source.name)
    except (FileError, ControlPointError) as error:
        raise type(error)(f"{path}: {error}") from None


def _settings(weights: str | None, parameters: dict[str, float | None], **others: Any) -> str:
    """The settings as the session file has them; the core refuses what is wrong with them."""
    unknown = parameters.keys() - set(PARAMETERS)
    if unknown:
        raise TypeError(f"unexpected keyword argument '{min(unknown)}'")
    chosen = {"kind": weights} if weights is not None else {}
    changes = {key: _plain(value) for key, value in others.items()}
    chosen |= {key: _plain(value) for key, value in parameters.items() if value is not None}
    if chosen:
        changes["weights"] = chosen
    try:
        return json.dumps(changes, allow_nan=False)
    except (TypeError, ValueError) as error:
        raise ArgumentError(f"settings: expected finite numbers and names, found {changes!r}: {error}") from None


def _plain(value: Any) -> Any:
    """A number of NumPy's as Python's own."""
    return value.item() if isinstance(value, np.generic) else value


def _box(points: ArrayLike, dimension: int) -> NDArray[np.float64]:
    x = as_points("shapes", points, dimension)
    if not len(x):
        raise ArgumentError("shapes: expected at least one point, found none")
    return box_around(x)


def _together(
    shapes: Iterable[Shape | ArrayLike], dimension: int
) -> tuple[NDArray[np.float64], NDArray[np.int64] | None]:
    """The points and triangles of several shapes as those of one."""
    points, triangles, count = [], [], 0
    for shape in shapes:
        x = shape.positions if isinstance(shape, Shape) else as_points("shapes", shape, dimension)
        if isinstance(shape, Shape) and shape.faces is not None:
            triangles.append(as_triangles(shape.faces, len(x)) + count)
        points.append(x)
        count += len(x)
    return np.concatenate(points), np.concatenate(triangles) if triangles else None
