"""Files of control points and sessions: bytes to what the core reads, and back."""

from __future__ import annotations

import os
from pathlib import Path

from neuralmls import _core
from neuralmls.errors import ControlPointError, FileError
from neuralmls.files import as_path, read_file, read_standard_input, write_atomically

STANDARD_INPUT = Path("-")


def read(path: str | os.PathLike[str]) -> _core.Read:
    """Read a file of any kind of control points, - from standard input.

    Raises
    ------
    FileError
        It is missing, or is not what it says it is; the message names the file, and the line or the JSON path.
    ControlPointError
        It is well-formed, but its control points cannot be used.
    """
    if as_path("path", path) == STANDARD_INPUT:
        return decode(read_standard_input(), "standard input")
    return decode(read_file(path), path)


def decode(data: bytes, path: str | os.PathLike[str]) -> _core.Read:
    """Read the bytes of such a file; `path` says its ending.

    Raises
    ------
    FileError, ControlPointError
        As `read`.
    """
    try:
        return _core.Read(data, os.path.basename(path))
    except (FileError, ControlPointError) as error:
        raise type(error)(f"{path}: {error}") from None


def write(session: _core.Session, path: str | os.PathLike[str]) -> None:
    """Write a session file (JSON), or the control points alone (CSV), by the ending.

    Raises
    ------
    FileError
        The ending is another one, or that of a CSV file, which holds no orientations, and there are some; or the file
        cannot be written; a file that was there is then untouched.
    """
    ending = as_path("path", path).suffix.lower()
    if ending not in (".json", ".csv"):
        raise FileError(f"{path}: expected a control-point file that ends in .json or .csv")
    try:
        text = session.to_json() if ending == ".json" else session.to_csv()
    except FileError as error:
        raise FileError(f"{path}: {error}") from None
    write_atomically(path, text.encode())
