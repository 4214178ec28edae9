"""Files that a shape names: they go where it goes, so that it opens there with its materials and textures."""

from __future__ import annotations

import os
import warnings
from pathlib import Path, PurePosixPath

from neuralmls.errors import FileError
from neuralmls.files import write_atomically

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
        return path.read_bytes()
    except OSError as error:
        raise FileError(f"cannot read '{name}' beside it: {error.strerror or error}") from error


def found_beside(names: list[str], folder: Path) -> dict[str, Path]:
    """The files of a folder that are named, and images that they name; not what is missing or leaves the folder."""
    paths = {name: _inside(folder, name) for name in [*names, *_images(names, folder)]}
    return {name: path for name, path in paths.items() if path is not None and path.is_file()}


def copy_along(names: list[str], source: Path, target: Path) -> list[Path]:
    """Copy the files of folder `source` that are named, and images that they name, into folder `target`.

    What is there already stays as it is, with a warning for each file that has another content; what is missing at
    the source, or leaves its folder, is passed over.

    Raises
    ------
    FileError
        A file cannot be written.
    """
    if source.resolve() == target.resolve():
        return []
    copied, kept = [], []
    for name, here in found_beside(names, source).items():
        there = _inside(target, name)
        if there is None:
            continue
        if os.path.lexists(there):
            if not _same_content(here, there):
                kept.append((here, there))
            continue
        try:
            there.parent.mkdir(parents=True, exist_ok=True)
            data = here.read_bytes()
        except OSError as error:
            raise FileError(f"{there}: cannot copy '{here}' along: {error.strerror or error}") from error
        write_atomically(there, data)
        copied.append(there)
    for here, there in kept:  # at the end: where warnings are errors, all else is copied first
        warnings.warn(f"{there}: kept, although it is not the '{here}' that the shape names", stacklevel=3)
    return copied


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
