"""Writing files: whole or not at all, as readable as they should be, and without what killed processes left."""

from __future__ import annotations

import os
import stat
import subprocess
import sys
import time
from pathlib import Path

import pytest

from neuralmls import files, leftovers
from neuralmls.errors import FileError

posix = pytest.mark.skipif(sys.platform == "win32", reason="permissions and processes are other ones there")


@pytest.fixture(autouse=True)
def first_write():
    """As if this process had not written anywhere before."""
    leftovers.remove.cache_clear()


def mode(path: Path) -> int:
    return stat.S_IMODE(path.stat().st_mode)


@pytest.fixture
def modes(monkeypatch) -> list[int]:
    """The permissions of each file at the moment it is complete, before it takes its name."""
    seen: list[int] = []
    sync = os.fsync

    def look(descriptor: int) -> None:
        seen.append(os.fstat(descriptor).st_mode)
        sync(descriptor)

    monkeypatch.setattr(os, "fsync", look)
    return seen


@posix
@pytest.mark.parametrize("permissions", [0o600, 0o640, 0o664, 0o444, 0o755])
def test_a_file_keeps_its_permissions_all_the_time(tmp_path, monkeypatch, modes, permissions):
    path = tmp_path / "a.obj"
    path.write_bytes(b"old")
    path.chmod(permissions)
    created: list[int] = []
    opening = os.open

    def opened(name, flags, mode=0o777, **options):
        descriptor = opening(name, flags, mode, **options)
        if flags & os.O_CREAT:
            created.append(stat.S_IMODE(os.fstat(descriptor).st_mode))
        return descriptor

    monkeypatch.setattr(os, "open", opened)
    files.write_atomically(path, b"new")
    assert (path.read_bytes(), mode(path)) == (b"new", permissions)
    assert [each & ~permissions for each in created] == [0], "never more than in the end"
    assert stat.S_IMODE(modes[0]) == permissions


@posix
@pytest.mark.parametrize("mask", [0o022, 0o077, 0o002])
def test_a_new_file_follows_the_umask(tmp_path, mask):
    before = os.umask(mask)
    try:
        files.write_atomically(tmp_path / "a.obj", b"new")
    finally:
        os.umask(before)
    assert mode(tmp_path / "a.obj") == 0o666 & ~mask


@posix
def test_files_and_the_names_in_their_folder_last(tmp_path, modes):
    (tmp_path / "there").mkdir()
    files.write_together({tmp_path / "a": b"1", tmp_path / "there" / "b": b"2", tmp_path / "c": b"3"})
    assert [stat.S_ISDIR(each) for each in modes] == [False, False, False, True, True]


KILLED = """
import os, signal, sys
from pathlib import Path
from neuralmls import files
os.fsync = lambda _: os.kill(os.getpid(), signal.SIGKILL)
files.write_atomically(Path(sys.argv[1]), b"half")
"""


@posix
def test_what_a_killed_process_left_is_removed_by_the_next_write(tmp_path):
    target = tmp_path / "a.obj"
    target.write_bytes(b"old")
    ran = subprocess.run([sys.executable, "-c", KILLED, str(target)], check=False)
    assert ran.returncode < 0
    assert len(list(tmp_path.iterdir())) == 2
    assert target.read_bytes() == b"old"
    files.write_atomically(tmp_path / "b.obj", b"new")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.obj", "b.obj"]


@posix
def test_nothing_else_is_removed(tmp_path, monkeypatch):
    mine = leftovers.beside(tmp_path / "a.obj").name
    with monkeypatch.context() as patch:
        patch.setattr(os, "getpid", lambda: 999_999_999)
        dead = leftovers.beside(tmp_path / "a.obj").name
    machine, _ = dead.removeprefix(".a.obj.").split("-", 1)
    foreign = dead.replace(machine, "00000000")
    kept = [mine, foreign, "a.part", "film.mkv.part", ".a.obj.1234abcd.part", ".note.part", ".a.12345678.part.obj"]
    for name in [*kept, dead]:
        (tmp_path / name).write_bytes(b"")
    (tmp_path / f"folder{dead}").mkdir()
    files.write_atomically(tmp_path / "b.obj", b"new")
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted([*kept, f"folder{dead}", "b.obj"])
    old = time.time() - 2 * leftovers.OLD
    for path in tmp_path.iterdir():
        if path.is_file():
            os.utime(path, (old, old))
    leftovers.remove.cache_clear()
    files.write_atomically(tmp_path / "b.obj", b"new")
    assert not any((tmp_path / name).exists() for name in (mine, foreign, ".a.obj.1234abcd.part"))
    assert all((tmp_path / name).exists() for name in kept[2:4] + kept[5:])


def test_a_name_that_is_too_long_is_blamed(tmp_path):
    name = "a" * 300 + ".obj"
    with pytest.raises(FileError, match=rf"{name}: cannot write: File name too long"):
        files.write_atomically(tmp_path / name, b"")
