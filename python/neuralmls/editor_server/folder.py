"""Files of a folder, opened so that nothing else is read in their place: no link, no pipe, no other folder."""

from __future__ import annotations

import os
import stat
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

# Windows has neither, and no pipes among its files.
_HELD = os.open in os.supports_dir_fd and hasattr(os, "O_NOFOLLOW")


class Folder:
    """A folder as it was found: what is put in its place later, or above it, is not read."""

    def __init__(self, path: Path) -> None:
        """Hold the folder open.

        Raises
        ------
        OSError
            It cannot be opened.
        """
        self.path = Path(os.path.realpath(path, strict=True))
        self._held = os.open(self.path, os.O_RDONLY | os.O_DIRECTORY) if _HELD else None

    def close(self) -> None:
        """Let go of the folder."""
        if self._held is not None:
            held, self._held = self._held, -1
            if held != -1:
                os.close(held)

    def file(self, path: Path) -> File | None:
        """A file that lies in this folder or below, wherever the links of `path` lead; None if it lies elsewhere."""
        real = Path(os.path.realpath(path))
        return File(self, real.relative_to(self.path).parts) if real.is_relative_to(self.path) else None

    def open(self, parts: tuple[str, ...]) -> BinaryIO:
        """Open the regular file that these names lead to without a link.

        Raises
        ------
        OSError
            There is none, or it cannot be read.
        """
        if self._held is None:
            path = self.path.joinpath(*parts)
            if os.path.realpath(path) != str(path) or not path.is_file():
                raise FileNotFoundError(path)
            return path.open("rb")
        *above, name = parts
        folder = os.dup(self._held)
        try:
            for step in above:
                below = os.open(step, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW, dir_fd=folder)
                os.close(folder)
                folder = below
            # A pipe would keep us waiting until somebody writes.
            opened = os.open(name, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK, dir_fd=folder)
        finally:
            os.close(folder)
        if not stat.S_ISREG(os.fstat(opened).st_mode):
            os.close(opened)
            raise FileNotFoundError(name)
        return open(opened, "rb")


@dataclass(frozen=True)
class File:
    """A file by its names below a folder."""

    folder: Folder
    parts: tuple[str, ...]

    def open(self) -> BinaryIO:
        """Open it as `Folder.open` does."""
        return self.folder.open(self.parts)
