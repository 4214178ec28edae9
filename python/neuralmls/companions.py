"""Files that a shape names: they go where it goes, so that it opens there with its materials and textures.

A name is read with either slash. What leaves the shape's folder (`..`, an absolute path, a symbolic link that leads
out) is refused by name: an unpacked archive must not make us copy or serve any file of its reader's.
"""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath

from neuralmls.errors import FileError
from neuralmls.files import read_bytes

# Statements of an MTL file that name an image: all that start with `map_`, and these.
_IMAGES = {"bump", "disp", "decal", "refl", "norm"}
# The options that stand before the name, each with its values.
_OPTIONS = re.compile(r"(?:-\w+\s+(?:(?:on|off|[-+]?\.?\d[-+.\deE]*|[rgbmlz]|sphere|cube_\w+)\s+)*)*")


@dataclass(frozen=True)
class Companions:
    """What became of the names in a shape's file."""

    found: dict[str, Path] = field(default_factory=dict)
    """Files in its folder, by those names."""
    missing: list[str] = field(default_factory=list)
    """Names of files that are not there."""
    refused: list[str] = field(default_factory=list)
    """Names that lead out of its folder."""

    @property
    def warnings(self) -> list[str]:
        """A sentence for each that does not go along."""
        return [
            *(f"'{name}', which the shape names, is not there: it goes without" for name in self.missing),
            *(f"'{name}', which the shape names, leads out of its folder: it is left behind" for name in self.refused),
        ]


def find_beside(names: list[str], missing: Callable[[list[str]], list[str]], folder: Path) -> Companions:
    """Look for the files that a shape in `folder` names, and for the images that its material libraries name.

    `missing` tells which of the names are missing, given those that are there: one name may be read in several ways.
    """
    found: dict[str, Path] = {}
    refused: list[str] = []

    def look(name: str) -> bool:
        if name not in found and name not in refused:
            if _leads_out(folder, name):
                refused.append(name)
            elif (path := _inside(folder, name)) is not None and path.is_file():
                found[name] = path
        return name in found or name in refused

    gone = missing([name for name in names if look(name)])
    for library in [path for path in found.values() if path.suffix.lower() == ".mtl"]:
        for readings in _images(library, folder):
            there = [look(image) for image in readings]
            if not any(there) and readings[-1] not in gone:
                gone.append(readings[-1])
    return Companions(found, gone, refused)


def read_beside(folder: Path, name: str) -> bytes:
    """Return the content of a file that a shape in `folder` names.

    Raises
    ------
    FileError
        The name leads out of the folder, or the file cannot be read.
    """
    path = _inside(folder, name)
    if path is None or _leads_out(folder, name):
        raise FileError(f"'{name}' leaves the shape's folder")
    try:
        return read_bytes(Path(os.path.realpath(path)), links=False)
    except OSError as error:
        raise FileError(f"cannot read '{name}' beside it: {error.strerror or error}") from error


def to_copy(found: dict[str, Path], source: Path, target: Path) -> tuple[dict[Path, Path], list[str]]:
    """What of the files found in folder `source` is to be copied into folder `target`; what is there already stays.

    Returns
    -------
    where each file goes, and where it is now; a warning for each that stays although it has another content
    """
    if source.resolve() == target.resolve():
        return {}, []
    copies: dict[Path, Path] = {}
    warnings = []
    for here in found.values():
        there = target / here.relative_to(source)
        if not os.path.lexists(there):
            copies[there] = Path(os.path.realpath(here))
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
        return one.samefile(other) or read_bytes(one) == read_bytes(other)
    except OSError:  # a folder, a pipe, a link to nothing
        return False


def _images(library: Path, folder: Path) -> list[list[str]]:
    """The images that a library names, relative to the shape: all readings of each statement, the likeliest last.

    Options stand before the name, which may have spaces itself.
    """
    try:
        text = read_bytes(Path(os.path.realpath(library)), links=False).decode(errors="replace")
    except OSError:
        return []
    beside = PurePosixPath(library.relative_to(folder).as_posix()).parent
    images = []
    for line in text.splitlines():
        keyword, _, rest = line.strip().partition(" ")
        if keyword.lower().startswith("map_") or keyword.lower() in _IMAGES:
            rest = rest.strip()
            likely = rest[len(_OPTIONS.match(rest + " ")[0]) :] or rest  # type: ignore[index]
            words = rest.split()
            readings = [*(" ".join(words[i:]) for i in range(len(words))), likely]
            if likely:
                images.append([str(beside / reading.replace("\\", "/")) for reading in readings])
    return images


def _inside(folder: Path, name: str) -> Path | None:
    """The path of a name that stays in its folder; backslashes are slashes where no file has them in its name."""
    if not name or ":" in name or "\0" in name:
        return None
    relative = PurePosixPath(name.replace("\\", "/"))
    if relative.is_absolute() or ".." in relative.parts or not relative.parts:
        return None
    literal = folder / name
    return literal if "\\" in name and literal.is_file() else folder.joinpath(*relative.parts)


def _leads_out(folder: Path, name: str) -> bool:
    """Whether a name is that of something which is not within the folder."""
    path = _inside(folder, name)
    if path is None:
        return "\0" not in name and os.path.isfile(folder / name.replace("\\", "/"))
    return not Path(os.path.realpath(path)).is_relative_to(os.path.realpath(folder))
