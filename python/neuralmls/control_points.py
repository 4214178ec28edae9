"""Control points: where a shape is held (sources, `p`) and where they are moved to (targets, `q`)."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from neuralmls import _core, session_files
from neuralmls.arrays import as_points
from neuralmls.errors import ArgumentError, ControlPointError
from neuralmls.orientations import Orientation
from neuralmls.tables import rows_table


class ControlPoints:
    """Named control points at rest and moved, in the coordinates of the shape's file.

    Parameters
    ----------
    sources : (m, d) float64, d = 1, 2 or 3
        The control points at rest, `p`.
    targets : (m, d) float64, optional
        The control points moved, `q`; without it, none is moved.
    names : m strings, optional
        One name for each; without it `p1` to `pm`.
    orientations : m times Orientation or None, optional
        How each is turned and scaled; None for one that only moves, and does not resist turning.
    weights : (m,), 0 to 1, optional
        How closely each is to be met, of what the handles of a session ask of all; 1 if not given.
    groups : m times str or None, optional
        What each moves with: control points of one group move as one rigid piece (with the similarity transform one
        that may be scaled), by the motion that fits their targets best, `min_R,t sum |R p_i + t - q_i|^2`, and what is
        around them turns with it, but around those that have an orientation of their own. None for one that is free.
    locked : (m,) bool, optional
        Whether each stays as it is at rest, whatever its target, and holds what is around it; with one of a group
        stays all of it.

    Raises
    ------
    ControlPointError
        There is none; two have the same name or the same source; a coordinate is not finite; shapes disagree; one
        cannot be oriented so in its dimension; a group is called nothing.

    Examples
    --------
    >>> points = ControlPoints([[0, 0, 0], [0, 1, 0]], names=["foot", "top"])
    >>> points.moved({"top": [0.25, 0, 0]}).targets.tolist()
    [[0.0, 0.0, 0.0], [0.25, 1.0, 0.0]]
    """

    def __init__(
        self,
        sources: ArrayLike,
        targets: ArrayLike | None = None,
        names: Sequence[str] | None = None,
        orientations: Sequence[Orientation | None] | None = None,
        weights: ArrayLike | None = None,
        groups: Sequence[str | None] | None = None,
        locked: ArrayLike | None = None,
    ) -> None:
        p = _table(sources, "sources")
        q = p if targets is None else _table(targets, "targets")
        if q.shape != p.shape:
            raise ControlPointError(f"expected as many targets as sources, {p.shape}, found {q.shape}")
        count = len(p)
        labels = [f"p{i + 1}" for i in range(count)] if names is None else list(names)
        oriented = [None] * count if orientations is None else list(orientations)
        closely = np.ones(count) if weights is None else np.asarray(weights, np.float64)
        pieces: list[str | None] = [None] * count if groups is None else list(groups)
        stay = np.zeros(count, bool) if locked is None else np.asarray(locked)
        if stay.dtype != bool:
            raise ControlPointError(f"locked: expected true or false for each control point, found {locked!r}")
        for what, listed in (
            ("a name", labels),
            ("an orientation or None", oriented),
            ("a weight", closely),
            ("a group or None", pieces),
            ("true or false", stay),
        ):
            if len(listed) != count:
                raise ControlPointError(f"expected {what} for each of {count} control points, found {len(listed)}")
        for i, label in enumerate(labels):
            if not isinstance(label, str):
                raise ControlPointError(f"control point {i + 1} has no name")
            _check_text(label, f"the name of control point {i + 1}")
        for i, group in enumerate(pieces):
            if group is not None:
                _check_text(group, f"the group of control point {i + 1}")
        self._core = _core.ControlPoints(labels, p, q, oriented, closely.tolist(), pieces, stay.tolist())

    @classmethod
    def _of(cls, core: _core.ControlPoints) -> Self:
        self = cls.__new__(cls)
        self._core = core
        return self

    @classmethod
    def read(cls, path: str | os.PathLike[str]) -> Self:
        """Read the control points of a file of any kind that `Session.read` reads.

        Raises
        ------
        FileError
            The file is missing, or is not what it says it is; the message names the line or the JSON path.
        ControlPointError
            The file is well-formed, but its control points cannot be used.
        """
        return cls._of(session_files.read(path).session.points)

    def write(self, path: str | os.PathLike[str]) -> None:
        """Write a control-point file, JSON or CSV by its ending; reading it gives the same bits.

        Raises
        ------
        FileError
            The ending is another one, or that of a CSV file, which holds no orientations, groups or locks, and there
            are some; or the file cannot be written; a file that was there is then untouched.
        """
        session_files.write(_core.Session(self._core), path)

    def __len__(self) -> int:
        return len(self._core)

    @property
    def names(self) -> tuple[str, ...]:
        """Their names."""
        return tuple(self._core.names)

    @property
    def sources(self) -> NDArray[np.float64]:
        """Where they are at rest, `p`, (m, d)."""
        return _fixed(self._core.sources)

    @property
    def targets(self) -> NDArray[np.float64]:
        """Where they are moved to, `q`, (m, d)."""
        return _fixed(self._core.targets)

    @property
    def dimension(self) -> int:
        """The number of coordinates of each control point: 1, 2 or 3."""
        return int(self._core.sources.shape[1])

    @property
    def orientations(self) -> tuple[Orientation | None, ...]:
        """How each is oriented; None for those that only move."""
        return tuple(self._core.orientations)

    @property
    def is_oriented(self) -> bool:
        """Whether any of them is oriented."""
        return any(orientation is not None for orientation in self.orientations)

    @property
    def rotations(self) -> NDArray[np.float64] | None:
        """The rotation of each, (m, d, d), NaN for those that are not oriented; None where none is."""
        return self._core.rotations

    @property
    def scales(self) -> NDArray[np.float64] | None:
        """The scale of each, (m,), NaN for those that are not oriented; None where none is."""
        return self._core.scales

    @property
    def weights(self) -> NDArray[np.float64]:
        """How closely each is to be met, (m,)."""
        return _fixed(self._core.weights)

    @property
    def groups(self) -> tuple[str | None, ...]:
        """The group of each; None for those that are free."""
        return tuple(self._core.groups)

    @property
    def locked(self) -> NDArray[np.bool_]:
        """Whether each is locked, (m,)."""
        return _fixed(self._core.locked)

    @property
    def mirror_of(self) -> tuple[str | None, ...]:
        """Whose mirror image each is; None for those that are nobody's."""
        return tuple(self._core.mirror_of)

    def grouped(self, names: Sequence[str], group: str | None) -> ControlPoints:
        """Return the same control points, the named ones in a group, or with None in none.

        Raises
        ------
        ArgumentError
            There is no such control point.
        ControlPointError
            The group is called nothing.

        Examples
        --------
        >>> points = ControlPoints([[0.0, 0], [1, 0], [5, 0]], names=["a", "b", "c"]).grouped(["a", "b"], "seat")
        >>> points.moved({"seat": [0, 2]}).targets.tolist()
        [[0.0, 2.0], [1.0, 2.0], [5.0, 0.0]]
        """
        if group is not None:
            _check_text(group, "the group")
        return ControlPoints._of(self._core.grouped(_names(names), group))

    def with_locked(self, names: Sequence[str]) -> ControlPoints:
        """Return the same control points, the named ones locked and no others.

        Raises
        ------
        ArgumentError
            There is no such control point.
        """
        return ControlPoints._of(self._core.with_locked(_names(names)))

    def oriented(self, orientations: Mapping[str, Orientation]) -> ControlPoints:
        """Return the same control points, the named ones turned and scaled further than they are.

        The name of a group turns and scales its targets about their middle.

        Raises
        ------
        ArgumentError
            There is no such control point, or it cannot be oriented so.
        """
        core = self._core
        for name, orientation in orientations.items():
            core = core.oriented(name, orientation)
        return ControlPoints._of(core)

    def moved(self, offsets: Mapping[str, ArrayLike]) -> ControlPoints:
        """Return the same control points, the targets of the named ones, or groups, moved by offsets, each (d,).

        Raises
        ------
        ArgumentError
            There is no such control point, or an offset has not d finite numbers.
        """
        core = self._core
        for name, offset in offsets.items():
            try:
                step = np.asarray(offset, dtype=np.float64).tolist()
                core = core.moved(name, step)
            except (TypeError, ValueError) as error:
                if isinstance(error, ArgumentError):
                    raise
                expected = f"{self.dimension} finite numbers to move by"
                raise ArgumentError(f"'{name}' needs {expected}, found {offset!r}") from None
        return ControlPoints._of(core)

    def with_targets(self, targets: ArrayLike) -> ControlPoints:
        """Return the same control points with other targets, (m, d).

        Raises
        ------
        ControlPointError
            There are not so many, or one is not finite.
        """
        return ControlPoints._of(self._core.with_targets(_table(targets, "targets")))

    def check(self, bounds: ArrayLike) -> list[str]:
        """Warn of control points that do not fit a shape or each other, one sentence for each kind.

        Far outside of the shape's box; the wrong axes or units, with those that would fit; targets that are the mirror
        image of the sources; control points (nearly) on a line, about which nothing says how they turn.

        Parameters
        ----------
        bounds : (2, d) float64
            The least and the greatest corner of the shape's box.

        Raises
        ------
        ControlPointError
            The control points have another dimension than the shape, or a coordinate so large that no length could
            be measured.
        """
        return self._core.check(as_points("bounds", bounds))

    def _repr_html_(self) -> str:
        p, q = self.sources, self.targets
        head = ["name", "at rest", "target", "moved"]
        columns: list[list[str]] = [list(self.names), _said(p), _said(q), _said(np.linalg.norm(q - p, axis=1)[:, None])]
        if self.is_oriented:
            head.append("orientation")
            columns.append(["" if one is None else str(one) for one in self.orientations])
        if (self.weights != 1).any():
            head.append("weight")
            columns.append(_said(self.weights[:, None]))
        if any(self.groups):
            head.append("group")
            columns.append([group or "" for group in self.groups])
        if self.locked.any():
            head.append("locked")
            columns.append(["locked" if one else "" for one in self.locked])
        return rows_table(f"{len(self)} control points", head, list(zip(*columns, strict=True)))

    def __reduce__(self) -> tuple[Any, ...]:
        return _restored, (_core.Session(self._core).to_json(),)


def _check_text(text: object, what: str) -> None:
    if not isinstance(text, str):
        raise ControlPointError(f"expected {what} to be a text, found {text!r}")
    if any("\ud800" <= letter <= "\udfff" for letter in text):  # no text file could hold it
        raise ControlPointError(f"{what} has half of a surrogate pair in it")


def _restored(text: str) -> ControlPoints:
    return ControlPoints._of(_core.Read(text.encode(), "points.json").session.points)


def _said(rows: NDArray[np.float64]) -> list[str]:
    """The numbers of each row, for a person to read."""
    return [", ".join(f"{value:.4g}" for value in row) for row in rows]


def _names(names: Sequence[str]) -> list[str]:
    if isinstance(names, str) or not all(isinstance(name, str) for name in names):
        raise ArgumentError(f"names: expected a list of names of control points, found {names!r}")
    return list(names)


def _fixed(array: NDArray[Any]) -> NDArray[Any]:
    array.flags.writeable = False
    return array


def _table(values: ArrayLike, what: str) -> NDArray[np.float64]:
    try:
        array = np.array(values, dtype=np.float64, order="C")
    except (TypeError, ValueError) as error:
        raise ControlPointError(f"expected {what} to be a table of numbers, (m, d): {error}") from error
    if array.size == 0:
        raise ControlPointError("there are no control points; at least one is needed")
    if array.ndim != 2 or array.shape[1] > 3:
        raise ControlPointError(f"expected {what} of shape (m, d) with d = 1, 2 or 3, found {array.shape}")
    return array
