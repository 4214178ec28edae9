"""Shapes: read from a file, and written back with other positions and everything else as it was."""

from __future__ import annotations

import os
from pathlib import Path, PurePosixPath

import numpy as np
from numpy.typing import ArrayLike, NDArray

from neuralmls import _core
from neuralmls.arrays import as_points
from neuralmls.errors import ArgumentError, FileError
from neuralmls.files import write_atomically


class Shape:
    """A shape as `read` found it in a file.

    Its file's bytes are kept, so that `write` can give them back with other positions and nothing else changed.
    """

    def __init__(self, path: Path, file: _core.ShapeFile) -> None:
        self._path = path
        self._file = file
        self._positions = file.positions()
        self._positions.flags.writeable = False
        self._faces = file.faces()

    @property
    def path(self) -> Path:
        """The file that it was read from."""
        return self._path

    @property
    def format(self) -> str:
        """The file's format: "OBJ", "PLY", "OFF", "STL", "glTF", "GLB", "XYZ/CSV" or "NPY"."""
        return self._file.format

    @property
    def extensions(self) -> list[str]:
        """The endings of files of this format, without the dot."""
        return self._file.extensions

    @property
    def positions(self) -> NDArray[np.float64]:
        """The positions of the vertices or points in file order, (n, 3), read-only; (n, 1 or 2) for narrow tables."""
        return self._positions

    @property
    def faces(self) -> NDArray[np.uint32] | None:
        """The faces as triangles (n-gons as fans), (f, 3); None where the file has none."""
        return self._faces

    @property
    def bounds(self) -> NDArray[np.float64]:
        """The box of the positions: least and greatest corner, (2, d)."""
        return np.stack([self._positions.min(axis=0), self._positions.max(axis=0)])

    @property
    def facts(self) -> list[tuple[str, str]]:
        """What else the file holds, and what a deformation does with it, for a person to read."""
        return self._file.facts

    @property
    def has_normals(self) -> bool:
        """Whether the file holds normals or tangents, which turn with the surface."""
        return self._file.has_normals

    def encode(
        self, positions: ArrayLike, *, maps: ArrayLike | None = None
    ) -> tuple[bytes, dict[str, bytes]]:
        """Return the file's bytes with other positions, and those of its changed side files (glTF buffers) by their name.

        Parameters and errors as for `write`.
        """
        x = as_points("positions", positions, self._positions.shape[1])
        m = None if maps is None else np.ascontiguousarray(maps, dtype=np.float64)
        if m is not None and m.ndim != 3:
            raise ArgumentError(f"maps: expected an (n, d, d) array, found shape {m.shape}")
        data, side_files = self._file.write(x, m)
        return data, dict(side_files)

    def write(
        self,
        path: str | os.PathLike[str],
        positions: ArrayLike,
        *,
        maps: ArrayLike | None = None,
    ) -> list[Path]:
        """Write the file with other positions; everything else is as it was. Unmoved, the file's very bytes.

        Side files whose content changes (the `.bin` of a `.gltf`) are written beside it. Files that the shape names and that are
        not there yet (materials, textures, unchanged buffers) are copied along when `path` is in another folder.

        Parameters
        ----------
        path : where to, with an ending of the same format
        positions : (n, d), in the units and order of `positions`
        maps : (n, d, d), optional
            The local maps of the deformation (`Deformer.deform(..., return_maps=True)`): normals turn by their inverse
            transpose. Without them, normals turn as the faces around each vertex do.

        Returns
        -------
        every file that was written, `path` first

        Raises
        ------
        ArgumentError
            The positions or maps do not fit the shape.
        FileError
            The ending is of another format, or a file cannot be written; what was there is then untouched.
        """
        target = Path(path)
        if target.suffix[1:].lower() not in self.extensions:
            endings = ", ".join(f".{ending}" for ending in self.extensions)
            raise FileError(f"{target}: a {self.format} file is written as {endings}, there is no conversion")
        data, side_files = self.encode(positions, maps=maps)
        written = []
        for name, content in side_files.items():
            beside = target.parent / name
            write_atomically(beside, content)
            written.append(beside)
        write_atomically(target, data)
        return [target, *written]


def read(path: str | os.PathLike[str]) -> Shape:
    """Read a shape: OBJ, PLY, OFF, STL, glTF, GLB, XYZ, TXT, CSV or NPY.

    Raises
    ------
    FileError
        The file is missing, broken or of a kind that is not read; the message names the line or byte.
    """
    source = Path(path)
    try:
        data = source.read_bytes()
    except OSError as error:
        raise FileError(f"{source}: cannot read: {error.strerror or error}") from error
    try:
        file = _core.ShapeFile(data, source.suffix[1:], lambda name: _side_file(source.parent, name))
    except FileError as error:
        raise FileError(f"{source}: {error}") from None
    return Shape(source, file)


def _side_file(folder: Path, name: str) -> bytes:
    """A file that the shape names, which must lie in its folder or below."""
    relative = PurePosixPath(name)
    if relative.is_absolute() or ".." in relative.parts or "\\" in name or ":" in name:
        raise FileError(f"'{name}' leaves the shape's folder")
    try:
        return folder.joinpath(*relative.parts).read_bytes()
    except OSError as error:
        raise FileError(f"cannot read '{name}' beside it: {error.strerror or error}") from error
