"""Files: read without waiting for what never comes, written so that nobody ever finds half of one."""

from __future__ import annotations

import errno
import io
import os
import shutil
import stat
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import BinaryIO

from neuralmls import leftovers
from neuralmls.errors import ArgumentError, FileError

# Opening a pipe waits for somebody to write into it; and what is a file may be one a moment later.
_WITHOUT_WAITING = getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_CLOEXEC", 0)
_BINARY = getattr(os, "O_BINARY", 0)
_NEW = os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_CLOEXEC", 0) | _BINARY


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


def read_bytes(path: Path, *, links: bool = True) -> bytes:
    """Return the content of a file, or of a pipe that the shell made (`<(...)`, /dev/stdin).

    Parameters
    ----------
    links : whether `path` may itself be a symbolic link

    Raises
    ------
    OSError
        It cannot be read; or it is a device or another pipe, which may have no end.
    """
    with _open(path, links=links) as file:
        return file.read()


def read_file(path: str | os.PathLike[str]) -> bytes:
    """Return the content of a file that a person named.

    Raises
    ------
    FileError
        It is missing, or cannot be read; the message names it.
    ArgumentError
        `path` is none.
    """
    try:
        return read_bytes(as_path("path", path))
    except FileNotFoundError as error:
        raise FileError(f"{path}: there is no such file") from error
    except OSError as error:
        raise FileError(f"{path}: cannot read: {error.strerror or error}") from error


def read_standard_input() -> bytes:
    """Return all that comes from standard input.

    Raises
    ------
    FileError
        It is closed, or cannot be read.
    """
    if sys.stdin is None:
        raise FileError("standard input: cannot read: it is closed")
    try:
        return sys.stdin.buffer.read()
    except OSError as error:
        raise FileError(f"standard input: cannot read: {error.strerror or error}") from error


def _open(path: Path, *, links: bool = True) -> BinaryIO:
    """Open what `read_bytes` reads, without waiting."""
    from_shell = links and path.parts[:2] in {("/", "dev"), ("/", "proc")}
    _check_kind(os.stat(path, follow_symlinks=links).st_mode, from_shell)  # opening a device may do something already
    descriptor = os.open(
        path, os.O_RDONLY | _WITHOUT_WAITING | _BINARY | (0 if links else getattr(os, "O_NOFOLLOW", 0))
    )
    file = open(descriptor, "rb")  # noqa: SIM115 (the caller closes it)
    try:
        _check_kind(os.fstat(descriptor).st_mode, from_shell)
        if stat.S_ISFIFO(os.fstat(descriptor).st_mode):
            os.set_blocking(descriptor, True)
    except OSError:
        file.close()
        raise
    return file


def _check_kind(mode: int, from_shell: bool) -> None:
    if stat.S_ISDIR(mode):
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR))
    if stat.S_ISLNK(mode):
        raise OSError("this is a link, not a file")
    if stat.S_ISFIFO(mode) and not from_shell:
        raise OSError("this is a pipe, not a file")
    if not (stat.S_ISREG(mode) or stat.S_ISFIFO(mode)):
        raise OSError("this is a device, not a file")


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
                leftovers.remove(target.parent)
                beside = leftovers.beside(target)
                complete.append((path, beside, target))
                _write_new(beside, source, mode)
        for path, beside, target in complete:
            with _naming(path):
                os.replace(beside, target)
        for folder in {target.parent for _, _, target in complete}:
            _sync(folder)
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
        return _open(content)
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
    """Write a file that is not there yet, always with the permissions of the one that it is to replace."""
    permissions = 0o666 if mode is None else stat.S_IMODE(mode)
    with open(os.open(path, _NEW, permissions & 0o777), "wb") as file:
        if mode is not None:
            os.chmod(path if os.chmod not in os.supports_fd else file.fileno(), permissions)  # what the umask took
        shutil.copyfileobj(source, file)
        file.flush()
        os.fsync(file.fileno())  # a full disk must show here, before the rename


def _sync(folder: Path) -> None:
    """Make the new names in a folder last, where the system can: a name may be lost in a power cut until then."""
    with suppress(OSError):
        descriptor = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)
