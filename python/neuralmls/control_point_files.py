"""The text of control-point files, JSON and CSV (docs/control-points.md): text to plain lists and back.

Every number is written as Python's `repr` writes it, the shortest text that reads back as the same double.
"""

from __future__ import annotations

import csv
import io
import json
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from neuralmls.errors import ArgumentError, FileError
from neuralmls.turns import Turn

FORMAT = "neuralmls-control-points"
VERSION = 1
AXES = "xyz"

# Names, sources, targets, turns.
Table = tuple[list[str], list[list[float]], list[list[float]], list[Turn | None]]


def read_text(path: str | os.PathLike[str]) -> str:
    """The text of a UTF-8 file that is not empty; errors do not name the file, the caller does."""
    try:
        text = Path(path).read_bytes().decode("utf-8-sig")
    except FileNotFoundError as error:
        raise FileError("there is no such file") from error
    except OSError as error:
        raise FileError(f"cannot read: {error.strerror or error}") from error
    except UnicodeDecodeError as error:
        found = error.object[error.start]
        raise FileError(f"byte {error.start}: expected UTF-8 text, found 0x{found:02x}") from error
    if not text.strip():
        raise FileError("the file is empty")
    return text


def parse_json(text: str) -> Table:
    """Read the JSON form. Keys that version 1 does not know are passed over."""
    try:
        document = json.loads(text)
    except json.JSONDecodeError as error:
        raise FileError(f"line {error.lineno}, column {error.colno}: not JSON: {error.msg}") from error
    except (RecursionError, ValueError) as error:  # nested or numbers beyond what Python takes
        raise FileError(f"not JSON that can be read: {error}") from error
    if not isinstance(document, dict):
        raise FileError(f"expected a JSON object, found {_kind(document)}")
    if document.get("format") != FORMAT:
        raise FileError(f'format: expected "{FORMAT}", found {_found(document, "format")}')
    version = document.get("version")
    if type(version) not in (int, float) or version != VERSION:
        raise FileError(f"version: expected {VERSION}, found {_found(document, 'version')}")
    entries = document.get("control_points")
    if not isinstance(entries, list) or not entries:
        found = _found(document, "control_points")
        raise FileError(f"control_points: expected a list with at least one control point, found {found}")
    names: list[str] = []
    sources: list[list[float]] = []
    targets: list[list[float]] = []
    turns: list[Turn | None] = []
    for i, entry in enumerate(entries):
        where = f"control_points[{i}]"
        if not isinstance(entry, dict):
            raise FileError(f"{where}: expected an object with a name and a position, found {_kind(entry)}")
        name = entry.get("name")
        if not isinstance(name, str) or not name.strip():
            raise FileError(f"{where}.name: expected a text that is not empty, found {_found(entry, 'name')}")
        dimension = len(sources[0]) if sources else None
        position = _json_vector(entry, "position", where, dimension)
        names.append(name)
        sources.append(position)
        targets.append(_json_vector(entry, "target", where, len(position)) if "target" in entry else position)
        turns.append(_json_turn(entry, where, len(position)))
    return names, sources, targets, turns


def _json_turn(entry: dict[str, Any], where: str, dimension: int) -> Turn | None:
    if "rotation" not in entry and "scale" not in entry:
        return None
    axis: tuple[float, ...] = (0.0, 0.0, 1.0) if dimension == 3 else ()
    degrees = 0.0
    if "rotation" in entry:
        rotation = entry["rotation"]
        if dimension == 1:
            raise FileError(f"{where}.rotation: a control point on a line has none")
        if not isinstance(rotation, dict):
            keys = "axis and degrees" if dimension == 3 else "degrees"
            raise FileError(f"{where}.rotation: expected an object with {keys}, found {_found(entry, 'rotation')}")
        if dimension == 3:
            axis = tuple(_json_vector(rotation, "axis", f"{where}.rotation", 3))
        degrees = _json_number(rotation, "degrees", f"{where}.rotation")
    scale = _json_number(entry, "scale", where) if "scale" in entry else 1.0
    try:
        return Turn(axis, degrees, scale)
    except ArgumentError as error:
        raise FileError(f"{where}: {error}") from error


def _json_number(entry: dict[str, Any], key: str, where: str) -> float:
    if type(entry.get(key)) not in (int, float):
        raise FileError(f"{where}.{key}: expected a number, found {_found(entry, key)}")
    try:
        return float(entry[key])
    except OverflowError as error:
        raise FileError(f"{where}.{key}: the number is too large") from error


def _json_vector(entry: dict[str, Any], key: str, where: str, dimension: int | None) -> list[float]:
    values = entry.get(key)
    expected = "1 to 3 numbers" if dimension is None else f"{dimension} number{'s' * (dimension > 1)}"
    numbers = values if isinstance(values, list) and all(type(v) in (int, float) for v in values) else []
    if len(numbers) != dimension and not (dimension is None and 1 <= len(numbers) <= 3):
        raise FileError(f"{where}.{key}: expected a list of {expected}, found {_found(entry, key)}")
    try:
        return [float(value) for value in numbers]
    except OverflowError as error:
        raise FileError(f"{where}.{key}: a number is too large") from error


def format_json(
    names: Sequence[str], sources: list[list[float]], targets: list[list[float]], turns: Sequence[Turn | None]
) -> str:
    """Write the JSON form, one control point a line."""
    entries = [
        {"name": name, "position": position, "target": target} | _turn_keys(turn, len(position))
        for name, position, target, turn in zip(names, sources, targets, turns, strict=True)
    ]
    lines = ["    " + json.dumps(entry, ensure_ascii=False, allow_nan=False) for entry in entries]
    head = f'{{\n  "format": "{FORMAT}",\n  "version": {VERSION},\n  "control_points": [\n'
    return head + ",\n".join(lines) + "\n  ]\n}\n"


def _turn_keys(turn: Turn | None, dimension: int) -> dict[str, Any]:
    if turn is None:
        return {}
    axis = {"axis": list(turn.axis)} if dimension == 3 else {}
    rotation = {"rotation": axis | {"degrees": turn.degrees}} if dimension > 1 else {}
    return rotation | ({"scale": turn.scale} if turn.scale != 1 or dimension == 1 else {})


def parse_csv(text: str) -> Table:
    """Read the CSV form: a header line, then one control point a line. Unknown columns are passed over."""
    reader = csv.reader(io.StringIO(text, newline=""), strict=True)
    names: list[str] = []
    sources: list[list[float]] = []
    targets: list[list[float]] = []
    columns: _Columns | None = None
    try:
        for row in reader:
            cells = [cell.strip() for cell in row]
            if not any(cells):
                continue
            where = f"line {reader.line_num}"
            if columns is None:
                columns = _Columns(cells, where)
                continue
            name, position, target = columns.entry(cells, where)
            names.append(name)
            sources.append(position)
            targets.append(target)
    except csv.Error as error:
        raise FileError(f"line {reader.line_num}: not CSV: {error}") from error
    if not names:
        raise FileError("there are no control points below the header line; at least one is needed")
    return names, sources, targets, [None] * len(names)


class _Columns:
    """Which column of a CSV file holds what, found in its header line."""

    def __init__(self, header: list[str], where: str) -> None:
        self.header = [title.lower() for title in header]
        for title in self.header:
            if title and self.header.count(title) > 1:
                raise FileError(f"{where}: the column '{title}' is there twice")
        plain, prefixed = self._axes(""), self._axes("source_")
        self.source = plain or prefixed
        self.target = self._axes("target_")
        if "name" not in self.header or not self.source or (plain and prefixed):
            raise FileError(
                f"{where}: expected the header name,x,y,z or name,x,y,z,target_x,target_y,target_z, "
                f"found {_short(','.join(header))}"
            )
        if any(title.startswith("target_") for title in self.header) and len(self.target) != len(self.source):
            whole = ",".join(f"target_{axis}" for axis in AXES[: len(self.source)])
            found = _short(",".join(header))
            raise FileError(f"{where}: expected all of the columns {whole} or none, found {found}")
        self.name = self.header.index("name")

    def _axes(self, prefix: str) -> list[int]:
        found = [prefix + axis in self.header for axis in AXES]
        count = sum(found)
        if found != [True] * count + [False] * (3 - count):
            return []  # z without y: not a position
        return [self.header.index(prefix + axis) for axis in AXES[:count]]

    def entry(self, cells: list[str], where: str) -> tuple[str, list[float], list[float]]:
        """One row's name, source and target."""
        if len(cells) > len(self.header):
            width = len(self.header)
            raise FileError(f"{where}: expected {width} columns as in the header, found {len(cells)}")
        cells = cells + [""] * (len(self.header) - len(cells))
        if not cells[self.name]:
            raise FileError(f"{where}: the control point has no name")
        position = [self._number(cells, column, where) for column in self.source]
        if not any(cells[column] for column in self.target):
            return cells[self.name], position, position
        return cells[self.name], position, [self._number(cells, column, where) for column in self.target]

    def _number(self, cells: list[str], column: int, where: str) -> float:
        cell = cells[column]
        try:
            if "_" in cell:  # Python would read 1_000 as a number; no other reader of CSV does
                raise ValueError
            return float(cell)
        except ValueError as error:
            found = _short(cell) if cell else "nothing"
            raise FileError(
                f"{where}: expected a number for {self.header[column]} of '{cells[self.name]}', found {found}"
            ) from error


def format_csv(names: Sequence[str], sources: list[list[float]], targets: list[list[float]]) -> str:
    """Write the CSV form, as a landmark file."""
    axes = AXES[: len(sources[0])]
    out = io.StringIO(newline="")
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(["name", *axes, *(f"target_{axis}" for axis in axes)])
    for name, position, target in zip(names, sources, targets, strict=True):
        writer.writerow([name, *map(repr, position), *map(repr, target)])
    return out.getvalue()


def _kind(value: object) -> str:
    kinds = {dict: "an object", list: "a list", str: "a text", bool: "true or false", type(None): "null"}
    return kinds.get(type(value), "a number")


def _found(entry: dict[str, Any], key: str) -> str:
    return _short(json.dumps(entry[key], ensure_ascii=False)) if key in entry else "nothing"


def _short(text: str) -> str:
    return text if len(text) <= 60 else text[:57] + "..."
