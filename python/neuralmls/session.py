"""Sessions, and what comes of them: control points and settings that, once fitted, are a map of space."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, Literal, Self, Unpack, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from neuralmls import _core, session_files
from neuralmls import _core as core  # where a class has an attribute of that name
from neuralmls.arrays import Progress, as_box, as_points, as_rows, box_around
from neuralmls.control_points import ControlPoints
from neuralmls.deformer import Deformer, Floats
from neuralmls.errors import ArgumentError, ControlPointError, FileError, NeuralMLSError
from neuralmls.files import read_file, write_atomically
from neuralmls.placement import as_indices
from neuralmls.report import Advice, Look, Report
from neuralmls.settings import Handles, Transform, WeightsName, changes_of
from neuralmls.shape import Shape
from neuralmls.shapes_together import box_of, together
from neuralmls.space import Space
from neuralmls.tables import fact_table
from neuralmls.weights import InverseDistanceWeights, NeuralWeights, ShapeAwareWeights, Weights
from neuralmls.weights.softmax import softmax

if TYPE_CHECKING:
    from neuralmls.figures.picture import Picture
    from neuralmls.figures.render import View

KINDS: dict[str, type[Weights]] = {
    kind._kind: kind for kind in (NeuralWeights, ShapeAwareWeights, InverseDistanceWeights)
}


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
    relax : float, 0 to 1
        How far the elastic finish goes: 0 is moving least squares alone; 1 lets the shape's own stiffness decide what
        the control points leave open. Above 0 the session is to be fitted to a shape.
    no_folds : bool
        Whether the map is to fold nothing over on the shapes of the fit: where one step does, it becomes as many small
        ones as it takes. Neural and inverse-distance weights, without `relax`. The session is to be fitted to a shape.
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
        relax: float = 0.0,
        no_folds: bool = False,
        frame: ArrayLike | None = None,
        **parameters: float | None,
    ) -> None:
        if not isinstance(points, ControlPoints):
            raise ArgumentError(f"points: expected ControlPoints, found {points!r}")
        said = {
            "transform": transform,
            "temperature": temperature,
            "handles": handles,
            "relax": relax,
            "no_folds": no_folds,
        }
        for name, value in {"weights": weights, **said}.items():
            if value is None:
                raise ArgumentError(f"{name}: expected a setting, found None")
        changes = changes_of(weights, parameters, **said)
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
        """Read control points of any kind: a session, a list of landmarks, files of other tools.

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
        found = session_files.read(path)
        if targets is not None:
            others = session_files.read(targets)
            try:
                found = found.joined(others, by_order)
            except (FileError, ControlPointError, ArgumentError) as error:
                raise type(error)(f"{path} and {targets}: {error}") from None
        return cls._of(found.session, found.notes)

    def write(self, path: str | os.PathLike[str]) -> None:
        """Write a session file (JSON), or the control points alone (CSV), by the ending; keys of others are kept.

        Raises
        ------
        FileError
            The ending is another one, or that of a CSV file, which holds no orientations, and there are some; or the
            file cannot be written; a file that was there is then untouched.
        """
        session_files.write(self._core, path)

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
        """Weights with parameters, transform, temperature, handles, relax, no_folds, as the session file has them."""
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
        relax: float | None = None,
        no_folds: bool | None = None,
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
        said = {
            "transform": transform,
            "temperature": temperature,
            "handles": handles,
            "relax": relax,
            "no_folds": no_folds,
        }
        changes = changes_of(weights, parameters, **{key: value for key, value in said.items() if value is not None})
        if changes != "{}":
            core = core.with_settings(changes)
        if frame is not None:
            core = core.with_frame(as_box(frame, self.points.dimension))
        return Session._of(core, self._notes)

    def fit(self, *shapes: Shape | ArrayLike, faces: ArrayLike | None = None, progress: Progress | None = None) -> Map:
        """Fit the weights to the control points: the map that `neuralmls deform` applies to these shapes.

        Parameters
        ----------
        shapes : Shape, or points (n, d)
            What it is for: the weights are trained in the box around all of them, unless the session has its own frame;
            shape-aware weights learn from all of them, `relax` takes their stiffness, and
            `no_folds` looks for folds there. Without any, in the box of
            the control points.
        faces : (f, 3) integers, optional
            Triangles of the points, where one array of points is all there is.
        progress : callable, optional
            Told the fraction done, from 0 to 1; what it raises stops the training.

        Raises
        ------
        ArgumentError
            A face names no point, or belongs to no one array of points; the shapes have another dimension, or no size;
            shape-aware weights, `relax` or `no_folds` without a shape, `relax` in 1D.
        """
        dimension = self.points.dimension
        boxes, bounds = [box_of(shape, dimension) for shape in shapes], self.frame
        if boxes and bounds is None:
            bounds = as_box(box_around(np.concatenate(boxes)), dimension)
        learns = self.weights == "shape-aware" or self.settings["relax"] > 0 or self.settings["no_folds"]
        shape = together(shapes, dimension) if shapes and learns else None
        if faces is not None:
            if len(shapes) != 1 or isinstance(shapes[0], Shape):
                raise ArgumentError("faces: expected them beside one array of points")
            triangles = as_indices(faces, len(as_points("shapes", shapes[0], dimension)))
            shape = (shape[0], triangles) if shape else None
        return Map._of(self._core.fit(bounds, shape, progress))

    def _repr_html_(self) -> str:
        return fact_table("Session", _facts(self)) + self.points._repr_html_()

    def __reduce__(self) -> tuple[Any, ...]:
        return _restored_session, (self._core.to_json(), self._notes)


class Map(Space):
    """A fitted session: where each point of space goes. Made by `Session.fit` or `Map.load`.

    The same map gives the same result for every file, block, process and machine, to rounding: bodies and their
    clothes, meshes and their landmarks stay together.

    Examples
    --------
    >>> points = ControlPoints([[0.0, 0], [1, 0]])
    >>> map = Session(points, weights="inverse-distance").fit()
    >>> map.moved(points.moved({"p2": [0, 0.5]})).at([[1.0, 0.0]]).round(6).tolist()
    [[1.0, 0.5]]
    """

    _core: core.Map

    @classmethod
    def _of(cls, made: core.Map) -> Self:
        self = cls.__new__(cls)
        self._core = made
        return self

    @classmethod
    def of(cls, session: Session, weights: Weights) -> Self:
        """Return the map of weights that were fitted already.

        Raises
        ------
        ArgumentError
            They are of another kind than the session's, or belong to other control points.
        """
        return cls._of(_core.Map.of(session._core, weights._core))

    @property
    def session(self) -> Session:
        """The control points, the settings, and the frame in which the weights were trained."""
        return Session._of(self._core.session)

    @property
    def weights(self) -> Weights:
        """The weights."""
        core = self._core.weights
        return KINDS[core.kind]._of(core)

    @property
    def side(self) -> float:
        """What lengths are measured by: the longest side of the box in which the weights were trained."""
        return self._core.side

    def with_session(self, session: Session) -> Map:
        """Return the map of another session with the same weights, as one with other targets, temperature or relax.

        With `no_folds` its steps are searched for anew.

        Raises
        ------
        ArgumentError
            The control points at rest or the settings of the weights are others, or `relax` or `no_folds` is set and
            was not at the fit: this needs a fit.
        """
        return Map._of(self._core.with_session(session._core))

    def moved(self, points: ControlPoints) -> Map:
        """Return the map with other targets and orientations of the same control points.

        Raises
        ------
        ArgumentError
            The control points at rest are others.
        """
        return Map._of(self._core.with_session(self._core.session.with_points(points._core)))

    def at(self, points: ArrayLike, *, progress: Progress | None = None) -> Floats:
        """Return where points (n, d), or a grid of them (h, w, 2), (d, h, w, 3), go: float32 if they are, else float64.

        Raises
        ------
        ArgumentError
            They are no finite points of the map's dimension.

        Examples
        --------
        >>> map = Session(ControlPoints([[0.0, 0]], targets=[[1.0, 0]]), weights="inverse-distance").fit()
        >>> map.at(np.zeros((4, 5, 2))).shape
        (4, 5, 2)
        """
        rows, grid = as_rows(points)
        y = self.deform(rows, progress=progress)
        return y if grid is None else y.reshape(*grid, -1)

    @overload
    def deform(
        self,
        shape: Shape | ArrayLike,
        *,
        return_maps: Literal[False] = ...,
        progress: Progress | None = ...,
    ) -> Floats: ...

    @overload
    def deform(
        self, shape: Shape | ArrayLike, *, return_maps: Literal[True], progress: Progress | None = ...
    ) -> tuple[Floats, NDArray[np.float64]]: ...

    def deform(
        self, shape: Shape | ArrayLike, *, return_maps: bool = False, progress: Progress | None = None
    ) -> Floats | tuple[Floats, NDArray[np.float64]]:
        """Return where the points of a shape go: what `neuralmls deform` writes.

        Parameters
        ----------
        shape : Shape, or points (n, d)
        return_maps : bool
            Also return the local maps `M`, (n, d, d) float64, by which normals turn (`Shape.write`).
        progress : callable, optional
            Told the fraction done, from 0 to 1; what it raises stops the call.

        Returns
        -------
        (n, d), float32 if the points were, else float64

        Raises
        ------
        ArgumentError
            The points are no finite points of the map's dimension.
        """
        y, maps = self.frame(self.bind(shape, progress=progress), return_maps=return_maps, progress=progress)
        return y if maps is None else (y, maps)

    def bind(self, shape: Shape | ArrayLike, *, progress: Progress | None = None) -> Deformer:
        """Evaluate the weights at points once, for many frames: `map.moved(points).frame(bound)`.

        Raises
        ------
        ArgumentError
            They are no finite points of the map's dimension.
        """
        x = shape.positions if isinstance(shape, Shape) else shape
        return Deformer._of_map(x, self._core, self.weights, self.session.settings["transform"], progress)

    def frame(
        self,
        bound: Deformer,
        *,
        return_maps: bool = False,
        out: NDArray[np.float64] | None = None,
        progress: Progress | None = None,
    ) -> tuple[Floats, NDArray[np.float64] | None]:
        """Return where bound points go, and the local maps (n, d, d) if they are asked for, else None.

        Parameters
        ----------
        bound : what `bind` returned for this map, or for one of the same weights and transform
        out : (n, d) C-contiguous float64, optional
            Where to write the result, which is then returned.
        progress : callable, optional
            Told the fraction done, from 0 to 1; what it raises stops the call.
        """
        positions, maps = self._core.deform(bound._core, return_maps, out, progress)
        y: Floats = positions if out is not None else positions.astype(bound._dtype, copy=False)
        return y, maps

    def report(self, shape: Shape | None = None) -> Report:
        """Return what happens to the control points; with a shape, in a file of its kind, which may round."""
        core = self._core.report(None if shape is None else shape._file)
        return Report(
            tuple(core.names),
            core.moved,
            core.distance_to_target,
            tuple(core.orientations),
            core.handles,
            core.soft,
            core.not_arrived,
            tuple(core.warnings),
            core.steps,
            core.least,
            core.folded,
        )

    def advise(self, shape: Shape | ArrayLike, faces: ArrayLike | None = None) -> list[Advice]:
        """Return what is likely bad about a deformed shape, and what would help; nothing where all moves as one.

        - misses: control points that stop short of their targets;
        - stiff: of 50 or more control points, that affine maps would follow their motion far more closely: with each of
          them left out, the others take it to its target at least twice as closely;
        - folds: places where space is turned inside out, `det J <= 0`, with `J` the Jacobian of the map;
        - torn: places where `J` stretches far more than in most places, as between control points that move apart;
        - ungoverned: a part that moves, and is far from all control points.

        What would help was tried: another temperature, soft handles and, where neither does, shape-aware weights
        are named only where they at least halve it, as is `no_folds` for folds; exact handles only where they arrive.

        Parameters
        ----------
        shape : Shape, or points (n, d)
        faces : (f, 3) integers, optional
            Triangles of the points; with them places are looked at by area, otherwise the points themselves.

        Raises
        ------
        ArgumentError
            There are no points, or a face names none.
        """
        x, triangles = self._surface(shape, faces)
        other = None if isinstance(self.weights, ShapeAwareWeights) else lambda: self._shape_aware(x, triangles)
        names = self._core.session.points.names
        return [
            Advice(kind, sentence, tuple(where), tuple(names[i] for i in near), amount)  # type: ignore[arg-type]
            for kind, sentence, where, near, amount in self._core.advise(x, as_indices(triangles, len(x)), other)
        ]

    def look(self, shape: Shape | ArrayLike, faces: ArrayLike | None = None) -> Look:
        """Return what the map does at 4,000 places of a shape: what `advise` judges by.

        Raises
        ------
        ArgumentError
            There are no points, or a face names none.
        """
        x, triangles = self._surface(shape, faces)
        return Look(*self._core.look(x, as_indices(triangles, len(x))))

    def plot(
        self,
        shape: Shape | ArrayLike,
        faces: ArrayLike | None = None,
        *,
        heat: str | int | None = None,
        **view: Unpack[View],
    ) -> Picture:
        """Return a picture of a shape at rest and deformed, which a notebook shows; `.write("map.png")` keeps it.

        The control points are drawn as balls, at rest with arrows to their targets. No display is needed.

        Parameters
        ----------
        shape : Shape, or points (n, d)
        faces : (f, 3) integers, optional
            Triangles of the points; without them they are drawn as a cloud.
        heat : str or int, optional
            What the shape is coloured by, from light to dark: a control point's name or number (from 0), for its weight
            `softmax(logits / T)`, 0 to 1; or "displacement", for how far each point moves, `|y - x|`, 0 to the most.
        azimuth, elevation : float, degrees
            Where the camera stands: turned from the front to the shape's left, risen from the ground.
        up : "y" or "z"
            The axis that is drawn upwards.
        width : int, pixels

        Raises
        ------
        NeuralMLSError
            PyVista is not installed (the extra `figures`), or cannot draw on this machine.
        ArgumentError
            There is no such control point; the points are no finite points of the map's dimension.

        Examples
        --------
        >>> points = ControlPoints([[0.0, 0, 0], [1, 0, 0]]).moved({"p2": [0, 0.5, 0]})
        >>> map = Session(points, weights="inverse-distance").fit()
        >>> map.plot(points.sources, heat="p2")                               # doctest: +SKIP
        """
        from neuralmls.figures.plots import of_map

        x, triangles = self._surface(shape, faces)
        temperature = self.session.settings["temperature"]
        return of_map(
            x,
            np.asarray(self.at(x), dtype=np.float64),
            triangles,
            self.session.points,
            heat,
            lambda: softmax(self.weights.logits(x), temperature),
            **view,
        )

    def _surface(
        self, shape: Shape | ArrayLike, faces: ArrayLike | None
    ) -> tuple[NDArray[np.float64], ArrayLike | None]:
        """The points and triangles that are looked at."""
        if isinstance(shape, Shape):
            return shape.positions, shape.faces
        return as_points("x", shape, self.session.points.dimension), faces

    def _shape_aware(self, x: NDArray[np.float64], faces: ArrayLike | None) -> core.Map | None:
        """The same with weights that know the shape; None where they cannot be fitted."""
        if x.shape[1] == 1:
            return None
        session = self._core.session.with_settings('{"weights": {"kind": "shape-aware"}}').with_frame(None)
        try:
            return session.fit(box_around(x), (x, as_indices(faces, len(x))), None)
        except NeuralMLSError:  # no size to measure by
            return None

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the map: weights bit for bit, and the session, as a safetensors file.

        Raises
        ------
        FileError
            The file cannot be written; what was there is untouched.
        """
        write_atomically(path, self._core.to_bytes())

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Self:
        """Read what `save` or `neuralmls fit` wrote. Nothing in the file is executed.

        Raises
        ------
        FileError
            The file is missing, or is no map.
        """
        data = read_file(path)
        try:
            return cls._of(_core.Map.from_bytes(data))
        except FileError as error:
            raise FileError(f"{path}: {error}") from None

    def _repr_html_(self) -> str:
        weights, facts = self.weights, _facts(self.session)
        if isinstance(weights, NeuralWeights):
            facts.append(("trained", f"{weights.steps} steps, mean cross-entropy {weights.loss:.3g}"))
        return fact_table("Map", facts) + self.session.points._repr_html_()

    def __reduce__(self) -> tuple[Any, ...]:
        return _restored_map, (self._core.to_bytes(),)


def _facts(session: Session) -> list[tuple[str, str]]:
    """The settings as a table of them: the weights with those of their parameters that are set."""
    said, frame = session.settings, session.frame
    parameters = {name: value for name, value in said.pop("weights").items() if name != "kind" and value is not None}
    listed = ", ".join(f"{name} {value}" for name, value in parameters.items())
    box = (
        "that of the shapes of fit" if frame is None else " to ".join(str(corner.round(4).tolist()) for corner in frame)
    )
    weights = f"{session.weights} ({listed})" if listed else session.weights
    return [("weights", weights), *((name, str(value)) for name, value in said.items()), ("frame", box)]


def _restored_session(text: str, notes: tuple[str, ...]) -> Session:
    return Session._of(_core.Read(text.encode(), "session.json").session, notes)


def _restored_map(data: bytes) -> Map:
    return Map._of(_core.Map.from_bytes(data))
