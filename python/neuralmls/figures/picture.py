"""A picture that was drawn: a notebook shows it, and it can be written."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from pathlib import Path

from neuralmls.errors import FileError
from neuralmls.files import write_atomically


@dataclass(frozen=True)
class Picture:
    """The bytes of a PNG file, which a notebook shows as a picture.

    Examples
    --------
    >>> picture = Picture(b"...")
    >>> picture, picture._repr_png_()
    (Picture(), b'...')
    """

    png: bytes = field(repr=False)

    def _repr_png_(self) -> bytes:
        return self.png

    def write(self, path: str | os.PathLike[str]) -> None:
        """Write the picture as a PNG file.

        Raises
        ------
        FileError
            `path` does not end in .png, or cannot be written; what was there is then untouched.
        """
        if Path(path).suffix.lower() != ".png":
            raise FileError(f"{path}: expected a name that ends in .png")
        write_atomically(path, self.png)
