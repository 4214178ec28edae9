"""Files that a command is to write: refused before any work is done, if they cannot or should not be."""

from __future__ import annotations

import os
import warnings
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from neuralmls.errors import ArgumentError, FileError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from neuralmls.shape import Shape

STANDARD_OUTPUT = Path("-")


def of_shapes(shapes: Sequence[Path], output: str) -> tuple[list[Path], Path | None]:
    """Return the file to write for each shape, and the folder that they are to be in, where it is one.

    One shape is written to `output` itself, unless that is a folder or ends as one; several by their names in it.

    Raises
    ------
    ArgumentError
        Two of them have the same name, one has none, or several are to go to standard output or to one file.
    """
    path = Path(output)
    is_folder = output.endswith(("/", os.sep)) or os.path.isdir(output)
    if len(shapes) == 1 and not is_folder:
        return [path], None
    if path == STANDARD_OUTPUT:
        raise ArgumentError("standard output takes one file: name a folder for several shapes")
    if not is_folder and path.suffix and path.suffix.lower() in {shape.suffix.lower() for shape in shapes}:
        raise ArgumentError(f"{output}: expected a folder for {len(shapes)} shapes, found the name of one file")
    names = [shape.name for shape in shapes]
    for name in names:
        if name == STANDARD_OUTPUT.name:
            raise ArgumentError(f"{output}: what comes from standard input has no name: name an output file")
        if names.count(name) > 1:
            raise ArgumentError(f"{output}: two shapes are called '{name}', and would be one file there")
    return [path / name for name in names], path


def check_output(path: Path, *, force: bool, inputs: Iterable[Path] = (), folder_comes: bool = False) -> None:
    """Refuse a path that is a folder, is in none or in one that is not writable, or has a file already.

    So is one whose name the disk does not take. Where the `folder_comes` later, it need not be there.

    Raises
    ------
    ArgumentError
        There is such a file, and no `force`; the path is an input.
    FileError
        Nothing can be written there.
    """
    if path == STANDARD_OUTPUT:
        return
    try:
        path.lstat()
    except (FileNotFoundError, NotADirectoryError):  # said below
        pass
    except OSError as error:  # too long a name
        raise FileError(f"{path}: cannot write here: {error.strerror or error}") from error
    for other in inputs:
        if same_file(path, other) and not force:
            raise ArgumentError(f"{path}: the output is the input itself; --force overwrites it")
    if path.is_dir():
        raise FileError(f"{path}: cannot write here: this is a folder")
    if path.is_file() and not force:
        raise ArgumentError(f"{path}: there is such a file already; --force overwrites it")
    folder = path.parent
    if folder_comes and not os.path.lexists(folder):
        return
    if not folder.is_dir():
        raise FileError(f"{path}: cannot write here: there is no folder '{folder}'")
    if not os.access(folder, os.W_OK):
        raise FileError(f"{path}: cannot write here: the folder '{folder}' is not writable")


def check_ending(path: Path, endings: Iterable[str], what: str) -> None:
    """Refuse a path that does not end as files of its kind do.

    Raises
    ------
    ArgumentError
        It has another ending.
    """
    allowed = list(endings)
    if path.suffix[1:].lower() not in allowed:
        shown = " or ".join(f".{ending}" for ending in allowed if ending)
        raise ArgumentError(f"{path}: expected a name that ends in {shown}, for {what}")


def make_folder(path: Path) -> None:
    """Make a folder where there is none yet.

    Raises
    ------
    FileError
        It cannot be made.
    """
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise FileError(f"{path}: cannot make this folder: {error.strerror or error}") from error


def write_shape(
    shape: Shape, path: Path, positions: ArrayLike, *, maps: ArrayLike | None = None, force: bool
) -> tuple[list[str], list[str]]:
    """Write a shape with other positions; return the files written, and warnings of others that are kept or missing."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        written = shape.write(path, positions, maps=maps, overwrite=force)
    return [str(file) for file in written], [str(warning.message) for warning in caught]


def same_file(one: Path, other: Path) -> bool:
    """Whether two paths are one file that exists."""
    try:
        return one.samefile(other)
    except OSError:
        return False
