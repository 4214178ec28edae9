"""Shapes: read from a file, and written back with other positions and everything else as it was."""

from __future__ import annotations

import os
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Unpack

import numpy as np
from numpy.typing import ArrayLike, NDArray

from neuralmls import _core
from neuralmls.arrays import as_points
from neuralmls.companions import Companions, find_beside, make_folders, read_beside, to_copy
from neuralmls.errors import ArgumentError, FileError
from neuralmls.files import as_path, read_file, write_together
from neuralmls.tables import fact_table

if TYPE_CHECKING:
    from neuralmls.control_points import ControlPoints
    from neuralmls.figures.picture import Picture
    from neuralmls.figures.render import View


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
        self._bounds = file.bounds()
        self._bounds.flags.writeable = False

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
        """The endings that the file may be written with, without the dot: those of its format, and its own."""
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
        """The box of the positions: least and greatest corner, (2, d), read-only."""
        return self._bounds

    def round(self, points: ArrayLike) -> NDArray[np.float64]:
        """Return points, (n, d), as the file holds them once it is written: 32-bit floats, digits, whole numbers.

        As many points as the shape has positions are taken for these: they become exactly what reading the written file
        gives. Others are places anywhere, as a vertex there would be held.

        Raises
        ------
        ArgumentError
            They do not fit the shape, or the file cannot hold one.
        """
        return self._file.round(as_points("points", points, self._positions.shape[1]))

    def step(self) -> float:
        """Return the largest distance between neighbouring numbers of the file's type at the shape's coordinates.

        0 where it holds doubles, or text, which is written as precisely as the shape needs.
        """
        return self._file.step()

    @property
    def facts(self) -> list[tuple[str, str]]:
        """What else the file holds, and what a deformation does with it, for a person to read."""
        return self._file.facts

    @property
    def has_normals(self) -> bool:
        """Whether the file holds normals or tangents, which turn with the surface."""
        return self._file.has_normals

    @property
    def companions(self) -> dict[str, Path]:
        """The files beside it that it names (materials, textures, buffers) and that are there, by those names."""
        return self.look_beside().found

    def look_beside(self) -> Companions:
        """Look for the files that it names: which are there now, which are missing, which lead out of its folder."""
        return find_beside(
            self._file.named_files, lambda found: self._file.missing_files(set(found)), self._path.parent
        )

    def side_files(self, stem: str) -> list[str]:
        """The files (glTF buffers) that `write` may write beside a file called after `stem` if the shape has moved."""
        return self._file.side_files(_sayable(stem))

    def plot(self, points: ControlPoints | None = None, **view: Unpack[View]) -> Picture:
        """Return a picture of the shape, which a notebook shows; `.write("shape.png")` keeps it. No display is needed.

        Parameters
        ----------
        points : ControlPoints, optional
            Drawn as balls where they are at rest, with arrows to their targets.
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
            The shape has no positions, or the width or `up` is none.

        Examples
        --------
        >>> import neuralmls as nm
        >>> nm.read("chair.obj").plot(nm.ControlPoints.read("points.json"), azimuth=60)  # doctest: +SKIP
        """
        from neuralmls.figures.plots import of_shape

        return of_shape(self._positions, self._faces, self._path.name, points, **view)

    def _repr_html_(self) -> str:
        count = 0 if self._faces is None else len(self._faces)
        size = " x ".join(f"{side:.6g}" for side in self._bounds[1] - self._bounds[0])
        facts = [("vertices", f"{len(self._positions):,}"), ("triangles", f"{count:,}"), ("size", size)]
        return fact_table(f"{_sayable(self._path.name)}: {self.format}", [*facts, *self.facts])

    def encode(
        self, positions: ArrayLike, *, maps: ArrayLike | None = None, stem: str | None = None
    ) -> tuple[bytes, dict[str, bytes]]:
        """Return the file's bytes with other positions, and those of its changed side files (glTF buffers) by name.

        The side files are called after `stem` if given, else as they were. Other parameters and errors as for `write`.
        """
        data, side_files = self._encode(positions, maps, stem)
        return data, {name: content for name, _, content in side_files}

    def _encode(
        self, positions: ArrayLike, maps: ArrayLike | None, stem: str | None
    ) -> tuple[bytes, list[tuple[str, str, bytes]]]:
        x = as_points("positions", positions, self._positions.shape[1])
        m = None if maps is None else np.ascontiguousarray(maps, dtype=np.float64)
        if m is not None and m.ndim != 3:
            raise ArgumentError(f"maps: expected an (n, d, d) array, found shape {m.shape}")
        return self._file.write(x, m, None if stem is None else _sayable(stem))

    def write(
        self,
        path: str | os.PathLike[str],
        positions: ArrayLike,
        *,
        maps: ArrayLike | None = None,
        overwrite: bool = True,
    ) -> list[Path]:
        """Write the file with other positions; everything else is as it was. Unmoved, the file's very bytes.

        Side files whose content changes are called after it (`bent.gltf`: `bent.bin`). Files that the shape names
        (materials, textures) are copied along into another folder, where they are not there yet; one that is there with
        another content is kept, and a warning names it, as it names what is missing or leads out of the shape's folder.

        Parameters
        ----------
        path : where to, with the file's own ending or another of its format
        positions : (n, d), in the units and order of `positions`
        maps : (n, d, d), optional
            The local maps of the deformation (`Deformer.deform(..., return_maps=True)`): normals turn by their inverse
            transpose. Without them, normals turn as the faces around each vertex do.
        overwrite : bool
            Whether files that are there may be replaced.

        Returns
        -------
        every file that was written, `path` first

        Raises
        ------
        ArgumentError
            The positions or maps do not fit the shape; a file is there and may not be replaced.
        FileError
            The ending is of another format, or a file cannot be written; all files are then as they were.
        """
        target = as_path("path", path)
        if target.suffix[1:].lower() not in self.extensions:
            endings = ", ".join(f".{ending}" for ending in self.extensions if ending)
            raise FileError(f"{target}: expected the ending {endings}, a file of the format {self.format} stays one")
        data, side_files = self._encode(positions, maps, target.stem)
        sides = {target.parent / name: content for name, _, content in side_files}
        for file in [target, *sides]:
            if not overwrite and os.path.isfile(file):  # a pipe holds nothing that could be lost
                raise ArgumentError(f"{file}: there is such a file already")
        replaced = {was for _, was, _ in side_files}
        beside = self.look_beside()
        named = {name: file for name, file in beside.found.items() if name not in replaced}
        to_go, kept = to_copy(named, self._path.parent, target.parent)
        copies = {there: here for there, here in to_go.items() if there != target and there not in sides}
        make_folders(copies)
        write_together({**copies, **sides, target: data})  # the shape last: whoever finds it, finds all that it needs
        for sentence in [*kept, *beside.warnings]:  # at the end: where warnings are errors, all is written first
            warnings.warn(sentence, stacklevel=2)
        return [target, *sides, *copies]


def _sayable(name: str) -> str:
    """A file's name as other files can hold it: bytes in it that are no UTF-8 are replaced."""
    return os.fsencode(name).decode(errors="replace")


def read(path: str | os.PathLike[str]) -> Shape:
    """Read a shape: OBJ, PLY, OFF, STL, glTF, GLB, NPY or a table of numbers (XYZ, TXT, CSV, ASC, PTS).

    Raises
    ------
    FileError
        The file is missing, broken or of a kind that is not read; the message names the line or byte.
    MemoryError
        There is not enough memory for it.
    ArgumentError
        `path` is none.
    """
    return decode(read_file(path), Path(path))


def decode(data: bytes, path: Path) -> Shape:
    """Read a shape from the bytes of a file; `path` says its ending, and where the files beside it are.

    Raises
    ------
    FileError
        They are broken or of a kind that is not read; the message names the line or byte.
    MemoryError
        There is not enough memory for it.
    """
    try:
        file = _core.ShapeFile(data, path.suffix[1:], lambda name: read_beside(path.parent, name))
    except FileError as error:
        raise FileError(f"{path}: {error}") from None
    return Shape(path, file)
