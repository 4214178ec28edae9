"""Control points: where a shape is held (sources, `p`) and where they are moved to (targets, `q`)."""

from __future__ import annotations

import difflib
import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from neuralmls.errors import ArgumentError, ControlPointError, FileError
from neuralmls.files import as_path
from neuralmls.turns import Turn

# How far outside of the shape's box (in longest sides of it) a control point is no longer taken for intended.
FAR_SOURCE = 1.0
FAR_TARGET = 10.0
LARGEST = 1e150  # units; beyond it, squares of lengths overflow


@dataclass(frozen=True, eq=False, init=False)
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
    turns : m times Turn or None, optional
        How each is turned and scaled; None for one that only moves, and does not resist turning.

    Raises
    ------
    ControlPointError
        There is none; two have the same name or the same source; a coordinate is not finite; shapes disagree; a turn is
        of another dimension.

    Examples
    --------
    >>> points = ControlPoints([[0, 0, 0], [0, 1, 0]], names=["foot", "top"])
    >>> points.moved({"top": [0.25, 0, 0]}).targets.tolist()
    [[0.0, 0.0, 0.0], [0.25, 1.0, 0.0]]
    """

    names: tuple[str, ...]
    sources: NDArray[np.float64]
    targets: NDArray[np.float64]
    turns: tuple[Turn | None, ...]

    def __init__(
        self,
        sources: ArrayLike,
        targets: ArrayLike | None = None,
        names: Sequence[str] | None = None,
        turns: Sequence[Turn | None] | None = None,
    ) -> None:
        p = _coordinates(sources, "sources")
        q = p.copy() if targets is None else _coordinates(targets, "targets")
        if q.shape != p.shape:
            raise ControlPointError(f"expected as many targets as sources, {p.shape}, found {q.shape}")
        labels = tuple(f"p{i + 1}" for i in range(len(p))) if names is None else tuple(names)
        _check_names(labels, len(p))
        _check_finite(p, labels, "position")
        _check_finite(q, labels, "target")
        _check_distinct(p, labels)
        turned = (None,) * len(p) if turns is None else tuple(turns)
        _check_turns(turned, labels, p.shape[1])
        p.flags.writeable = q.flags.writeable = False
        object.__setattr__(self, "names", labels)
        object.__setattr__(self, "sources", p)
        object.__setattr__(self, "targets", q)
        object.__setattr__(self, "turns", turned)

    def __len__(self) -> int:
        return len(self.names)

    @property
    def dimension(self) -> int:
        """The number of coordinates of each control point: 1, 2 or 3."""
        return int(self.sources.shape[1])

    @classmethod
    def read(cls, path: str | os.PathLike[str]) -> ControlPoints:
        """Read a control-point file, JSON or CSV by its ending (docs/control-points.md).

        Raises
        ------
        FileError
            The file is missing, or is not what its ending says; the message names the line or the JSON path.
        ControlPointError
            The file is well-formed, but its control points cannot be used.
        """
        from neuralmls import control_point_files as files

        parse = files.parse_json if _ending(path) == ".json" else files.parse_csv
        try:
            names, sources, targets, turns = parse(files.read_text(path))
            return cls(sources, targets, names, turns)
        except FileError as error:
            raise FileError(f"{path}: {error}") from error
        except ControlPointError as error:
            raise ControlPointError(f"{path}: {error}") from error

    def write(self, path: str | os.PathLike[str]) -> None:
        """Write a control-point file, JSON or CSV by its ending; reading it gives the same bits.

        Raises
        ------
        FileError
            The ending is another one, or that of a CSV file, which holds no turns, and there are some; or the file
            cannot be written; a file that was there is then untouched.
        """
        from neuralmls import control_point_files as files
        from neuralmls.files import write_atomically

        p, q = self.sources.tolist(), self.targets.tolist()
        if _ending(path) == ".json":
            text = files.format_json(self.names, p, q, self.turns)
        elif self.is_turned:
            raise FileError(f"{path}: a CSV file holds no rotations: write a file that ends in .json")
        else:
            text = files.format_csv(self.names, p, q)
        write_atomically(path, text.encode())

    @property
    def is_turned(self) -> bool:
        """Whether any of them carries a turn."""
        return any(turn is not None for turn in self.turns)

    @property
    def rotations(self) -> NDArray[np.float64] | None:
        """The rotation of each, (m, d, d), NaN for those that carry none; None where none does."""
        if not self.is_turned:
            return None
        d = self.dimension
        return np.array([np.full((d, d), np.nan) if turn is None else turn.matrix[:d, :d] for turn in self.turns])

    @property
    def scales(self) -> NDArray[np.float64] | None:
        """The scale of each, (m,), NaN for those that carry none; None where none does."""
        return np.array([np.nan if turn is None else turn.scale for turn in self.turns]) if self.is_turned else None

    def turned(self, turns: Mapping[str, Turn]) -> ControlPoints:
        """Return the same control points, the named ones turned further than they are.

        Raises
        ------
        ArgumentError
            There is no such control point, or it cannot turn so.
        """
        all_turns = list(self.turns)
        for name, turn in turns.items():
            i = self._index(name)
            if not turn.fits(self.dimension):
                how = {
                    1: "on a line: it cannot turn",
                    2: "in the plane: it turns about no axis",
                    3: "in space: it turns about an axis, of three numbers",
                }
                raise ArgumentError(f"'{name}' is {how[self.dimension]}")
            before = all_turns[i]
            all_turns[i] = turn if before is None else Turn.of(turn.matrix @ before.matrix, turn.scale * before.scale)
        return ControlPoints(self.sources, self.targets, self.names, all_turns)

    def _index(self, name: str) -> int:
        if name not in self.names:
            near = difflib.get_close_matches(name, self.names, n=1, cutoff=0.0)
            raise ArgumentError(f"there is no control point '{name}'; the nearest name is '{near[0]}'")
        return self.names.index(name)

    def moved(self, offsets: Mapping[str, ArrayLike]) -> ControlPoints:
        """Return the same control points, the targets of the named ones moved by offsets, each (d,).

        Raises
        ------
        ArgumentError
            There is no such control point, or an offset has not d finite numbers.
        """
        targets = self.targets.copy()
        for name, offset in offsets.items():
            i = self._index(name)
            try:
                step = np.asarray(offset, dtype=np.float64)
            except (TypeError, ValueError):
                step = np.empty(0)
            if step.shape != (self.dimension,) or not np.isfinite(step).all():
                raise ArgumentError(f"'{name}' needs {self.dimension} finite numbers to move by, found {offset!r}")
            targets[i] += step
        return ControlPoints(self.sources, targets, self.names, self.turns)

    def check(self, bounds: ArrayLike) -> list[str]:
        """Warn of control points that lie far outside of the shape's box, one sentence for each kind.

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
        low, high = np.asarray(bounds, dtype=np.float64)
        if low.shape != (self.dimension,):
            raise ControlPointError(
                f"the control points have {self.dimension} coordinates each, but the shape has {low.size}"
            )
        side = float((high - low).max())
        warnings = []
        for points, what, limit in (
            (self.sources, "position", FAR_SOURCE),
            (self.targets, "target", FAR_TARGET),
        ):
            huge = np.flatnonzero((np.abs(points) > LARGEST).any(axis=1))
            if huge.size:
                listed = _listed(self.names[i] for i in huge)
                raise ControlPointError(
                    f"the {what} of {listed} has a coordinate beyond {LARGEST:g}: no coordinates of a real thing"
                )
            distance = np.linalg.norm(np.maximum(np.maximum(low - points, points - high), 0.0), axis=1)
            far = [self.names[i] for i in np.flatnonzero(distance > limit * side)]
            if far:
                warnings.append(
                    f"the {what} of {_listed(far)} lies up to {distance.max():.6g} units outside of the "
                    f"shape, whose longest side is {side:.6g}: wrong coordinates are the usual mistake"
                )
        return warnings


def _ending(path: str | os.PathLike[str]) -> str:
    ending = as_path("path", path).suffix.lower()
    if ending not in (".json", ".csv"):
        raise FileError(f"{path}: expected a control-point file that ends in .json or .csv")
    return ending


def _coordinates(values: ArrayLike, what: str) -> NDArray[np.float64]:
    try:
        array = np.array(values, dtype=np.float64, order="C")
    except (TypeError, ValueError) as error:
        raise ControlPointError(f"expected {what} to be a table of numbers, (m, d): {error}") from error
    if array.size == 0:
        raise ControlPointError("there are no control points; at least one is needed")
    if array.ndim != 2 or array.shape[1] > 3:
        raise ControlPointError(f"expected {what} of shape (m, d) with d = 1, 2 or 3, found {array.shape}")
    return array


def _check_names(names: tuple[str, ...], count: int) -> None:
    if len(names) != count:
        raise ControlPointError(f"expected a name for each of {count} control points, found {len(names)}")
    seen = set()
    for i, name in enumerate(names):
        if not isinstance(name, str) or not name.strip():
            raise ControlPointError(f"control point {i + 1} has no name")
        if any("\ud800" <= letter <= "\udfff" for letter in name):  # no text file could hold it
            raise ControlPointError(f"the name of control point {i + 1} has half of a surrogate pair in it")
        if name in seen:
            raise ControlPointError(f"the name '{name}' is given to more than one control point")
        seen.add(name)


def _check_finite(points: NDArray[np.float64], names: tuple[str, ...], what: str) -> None:
    bad = np.flatnonzero(~np.isfinite(points).all(axis=1))
    if bad.size:
        found = ", ".join(map(str, points[bad[0]]))
        raise ControlPointError(f"the {what} of '{names[bad[0]]}' is not finite: ({found})")


def _check_distinct(points: NDArray[np.float64], names: tuple[str, ...]) -> None:
    seen: dict[tuple[float, ...], str] = {}
    for name, place in zip(names, map(tuple, points.tolist()), strict=True):
        other = seen.setdefault(place, name)
        if other is not name:
            at = ", ".join(f"{value:.9g}" for value in place)
            raise ControlPointError(f"'{other}' and '{name}' are at the same place, ({at})")


def _check_turns(turns: tuple[Turn | None, ...], names: tuple[str, ...], dimension: int) -> None:
    if len(turns) != len(names):
        raise ControlPointError(f"expected a turn or None for each of {len(names)} control points, found {len(turns)}")
    for turn, name in zip(turns, names, strict=True):
        if turn is not None and not turn.fits(dimension):
            raise ControlPointError(f"'{name}' has {dimension} coordinates, and cannot turn as {turn}")


def _listed(names: Iterable[str]) -> str:
    quoted = [f"'{name}'" for name in names]
    if len(quoted) > 5:
        return ", ".join(quoted[:5]) + f" and {len(quoted) - 5} more"
    return " and ".join(filter(None, [", ".join(quoted[:-1]), quoted[-1]]))
