"""Writing files so that nobody ever finds half of one: write beside, then rename."""

from __future__ import annotations

import io
import os
import secrets
import shutil
import stat
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import BinaryIO

from neuralmls.errors import ArgumentError, FileError


def as_path(name: str, path: str | os.PathLike[str]) -> Path:
    """Return an argument that should be a path as one.

    Raises
    ------
    ArgumentError
        It is none.
    """
    try:
        if b"\0" in os.fsencode(path):
            raise ValueError
        return Path(path)
    except (TypeError, ValueError):
        raise ArgumentError(f"{name}: expected the path of a file, found {path!r}") from None


def read_bytes(path: Path) -> bytes:
    """Return the content of a file or pipe.

    Raises
    ------
    OSError
        It cannot be read; or it is a device, which may have no end.
    """
    mode = path.stat().st_mode
    if stat.S_ISCHR(mode) or stat.S_ISBLK(mode):
        raise OSError("this is a device, not a file")
    return path.read_bytes()


def write_atomically(path: str | os.PathLike[str], data: bytes) -> None:
    """Write `data` to `path`: into a new file beside it, which then takes its name.

    A file that is there keeps its content until the new one is complete, and its permissions after it; a
    symbolic link stays a link. What is no regular file (a pipe, /dev/stdout) is written to directly.

    Raises
    ------
    ArgumentError
        `path` is none.
    FileError
        The folder does not exist, is not writable, or the disk is full. `path` is then as it was.
    """
    write_together({as_path("path", path): data})


def write_together(files: Mapping[Path, bytes | Path]) -> None:
    """Write files that belong together, each as `write_atomically` does: bytes, or what is in another file.

    None takes its name before all are complete; then they do in the order given.

    Raises
    ------
    FileError
        One cannot be written. All are then as they were, unless it is a name that cannot be taken (that of another
        person's file in a sticky folder): then those before it have theirs.
    """
    complete: list[tuple[Path, Path, Path]] = []
    try:
        for path, content in files.items():
            target = Path(os.path.realpath(path))
            with _naming(path), _opened(content) as source:
                mode = _mode(path, target)
                if mode is not None and not stat.S_ISREG(mode):
                    with open(target, "wb") as pipe:
                        shutil.copyfileobj(source, pipe)
                    continue
                beside = target.with_name(f".{target.name[:40]}.{secrets.token_hex(4)}.part")
                complete.append((path, beside, target))
                _write_new(beside, source, mode)
        for path, beside, target in complete:
            with _naming(path):
                os.replace(beside, target)
    finally:
        for _, beside, _ in complete:
            with suppress(OSError):
                beside.unlink(missing_ok=True)


@contextmanager
def _naming(path: Path) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        raise FileError(f"{path}: cannot write: {error.strerror or error}") from error


def _opened(content: bytes | Path) -> BinaryIO:
    if isinstance(content, bytes):
        return io.BytesIO(content)
    try:
        return open(content, "rb")
    except OSError as error:
        raise FileError(f"{content}: cannot read: {error.strerror or error}") from error


def _mode(path: Path, target: Path) -> int | None:
    """What kind of file is there, None where there is none."""
    mode = target.stat().st_mode if target.exists() else None
    if mode is not None and stat.S_ISDIR(mode):
        raise FileError(f"{path}: cannot write here: this is a folder")
    if mode is None and not target.parent.is_dir():
        raise FileError(f"{path}: cannot write here: there is no folder '{target.parent}'")
    return mode


def _write_new(path: Path, source: BinaryIO, mode: int | None) -> None:
    """Write a file that is not there yet, with the permissions of the one that it is to replace."""
    with open(path, "xb") as file:
        shutil.copyfileobj(source, file)
        file.flush()
        os.fsync(file.fileno())  # a full disk must show here, before the rename
    if mode is not None:
        path.chmod(stat.S_IMODE(mode))
