"""Files that a write leaves behind when its process is killed, and how the next write in that folder knows them."""

from __future__ import annotations

import os
import re
import secrets
import socket
import sys
import time
import zlib
from contextlib import suppress
from functools import cache
from pathlib import Path

# A write takes seconds: what is as old as this is nobody's, whatever process has its number now.
OLD = 24 * 3600.0

_NAME = re.compile(r"\..*\.(?:([0-9a-f]{8})-([0-9]+)-)?[0-9a-f]{8}\.part", re.DOTALL)


@cache
def _machine() -> str:
    """What tells the processes of this machine from those of another that writes into the same folder."""
    return f"{zlib.crc32(socket.gethostname().encode()):08x}"


def beside(target: Path) -> Path:
    """A new name beside `target` for what is written before it takes that name: hidden, and with whose it is."""
    owner = f"{_machine()}-{os.getpid()}-{secrets.token_hex(4)}"
    return target.with_name(f".{target.name[:40]}.{owner}.part")


@cache
def remove(folder: Path) -> None:
    """Remove what killed processes left in a folder; once a folder and process."""
    with suppress(OSError), os.scandir(folder) as entries:
        for entry in entries:
            found = _NAME.fullmatch(entry.name) if entry.name.endswith(".part") else None
            with suppress(OSError):
                if found and entry.is_file(follow_symlinks=False) and _is_left(found, entry):
                    os.unlink(entry.path)


def _is_left(found: re.Match[str], entry: os.DirEntry[str]) -> bool:
    if time.time() - entry.stat(follow_symlinks=False).st_mtime > OLD:
        return True
    machine, process = found.groups()
    return machine == _machine() and not _lives(int(process))


def _lives(process: int) -> bool:
    if sys.platform == "win32":  # there, no signal asks
        return True
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except (OSError, OverflowError):  # another person's
        return True
    return True
