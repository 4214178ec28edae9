"""Writing files so that nobody ever finds half of one: write beside, then rename."""

from __future__ import annotations

import os
import secrets
import stat
from pathlib import Path

from neuralmls.errors import ArgumentError, FileError


def as_path(name: str, path: str | os.PathLike[str]) -> Path:
    """Return an argument that should be a path as one.

    Raises
    ------
    ArgumentError
        It is none.
    """
    try:
        return Path(path)
    except TypeError:
        raise ArgumentError(f"{name}: expected the path of a file, found {path!r}") from None


def write_atomically(path: str | os.PathLike[str], data: bytes) -> None:
    """Write `data` to `path`: into a new file beside it, which then takes its name.

    A file that is there keeps its content until the new one is complete, and its permissions after it; a
    symbolic link stays a link. What is no regular file (a pipe, /dev/stdout) is written to directly.

    Raises
    ------
    FileError
        The folder does not exist, is not writable, or the disk is full. `path` is then as it was.
    """
    target = Path(os.path.realpath(path))
    try:
        mode = target.stat().st_mode if target.exists() else None
        if mode is not None and stat.S_ISDIR(mode):
            raise FileError(f"{path}: cannot write here: this is a folder")
        if mode is not None and not stat.S_ISREG(mode):
            target.write_bytes(data)
            return
        if not target.parent.is_dir():
            raise FileError(f"{path}: cannot write here: there is no folder '{target.parent}'")
        beside = target.with_name(f".{target.name[:100]}.{secrets.token_hex(4)}.part")
        try:
            with open(beside, "xb") as file:
                file.write(data)
                file.flush()
                os.fsync(file.fileno())  # a full disk must show here, before the rename
            if mode is not None:
                beside.chmod(stat.S_IMODE(mode))
            os.replace(beside, target)
        except BaseException:
            beside.unlink(missing_ok=True)
            raise
    except OSError as error:
        raise FileError(f"{path}: cannot write: {error.strerror or error}") from error
