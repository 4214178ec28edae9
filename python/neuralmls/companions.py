"""Files that a shape names: they go where it goes, so that it opens there with its materials and textures."""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path, PurePosixPath

from neuralmls.errors import FileError
from neuralmls.files import read_bytes

# Statements of an MTL file that name an image: all that start with `map_`, and these.
_IMAGES = {"bump", "disp", "decal", "refl", "norm"}


def read_beside(folder: Path, name: str) -> bytes:
    """Return the content of a file that a shape in `folder` names.

    Raises
    ------
    FileError
        The name leaves the folder, or the file cannot be read.
    """
    path = _inside(folder, name)
    if path is None:
        raise FileError(f"'{name}' leaves the shape's folder")
    try:
        return read_bytes(path)
    except OSError as error:
        raise FileError(f"cannot read '{name}' beside it: {error.strerror or error}") from error


def found_beside(names: list[str], folder: Path) -> dict[str, Path]:
    """The files of a folder that are named, and images that they name; not what is missing or leaves the folder."""
    paths = {name: _inside(folder, name) for name in [*names, *_images(names, folder)]}
    return {name: path for name, path in paths.items() if path is not None and path.is_file()}


def to_copy(names: list[str], source: Path, target: Path) -> tuple[dict[Path, Path], list[str]]:
    """What of the named files of folder `source`, and images that they name, is to be copied into folder `target`.

    What is missing at the source, or leaves its folder, is passed over; what is there already stays as it is.

    Returns
    -------
    where each file goes, and where it is now; a warning for each that stays although it has another content
    """
    if source.resolve() == target.resolve():
        return {}, []
    copies: dict[Path, Path] = {}
    warnings = []
    for name, here in found_beside(names, source).items():
        there = _inside(target, name)
        if there is None:
            continue
        if not os.path.lexists(there):
            copies[there] = here
        elif not _same_content(here, there):
            warnings.append(f"{there}: kept, although it is not the '{here}' that the shape names")
    return copies, warnings


def make_folders(files: Iterable[Path]) -> None:
    """Make the folders that files are to be written into, where there are none.

    Raises
    ------
    FileError
        One cannot be made.
    """
    for file in files:
        try:
            file.parent.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise FileError(f"{file}: cannot make its folder: {error.strerror or error}") from error


def _same_content(one: Path, other: Path) -> bool:
    try:
        return one.samefile(other) or one.read_bytes() == other.read_bytes()
    except OSError:  # a folder, a link to nothing
        return False


def _images(names: list[str], folder: Path) -> list[str]:
    """The images that material libraries among the named files name, relative to the shape."""
    images = []
    for name in names:
        library = _inside(folder, name)
        if library is None or library.suffix.lower() != ".mtl" or not library.is_file():
            continue
        for line in library.read_text(errors="replace").splitlines():
            keyword, _, rest = line.strip().partition(" ")
            if keyword.lower().startswith("map_") or keyword.lower() in _IMAGES:
                # Options stand before the name, which may have spaces itself.
                words = rest.split()
                found = (" ".join(words[i:]) for i in range(len(words)))
                images += [str(PurePosixPath(name).parent / image.replace("\\", "/")) for image in found]
    return images


def _inside(folder: Path, name: str) -> Path | None:
    """The path of a name that stays in its folder."""
    relative = PurePosixPath(name)
    if relative.is_absolute() or ".." in relative.parts or ":" in name or "\0" in name or not relative.parts:
        return None
    return folder.joinpath(*relative.parts)
