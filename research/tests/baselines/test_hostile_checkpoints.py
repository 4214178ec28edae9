"""Whatever is in a checkpoint's archive or pickle, it is read or refused in a sentence: mutated thousands of times."""

from __future__ import annotations

import io
import struct
import zipfile
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest

from neuralmls.cli import main
from neuralmls.errors import FileError
from neuralmls_research.baselines.kpd.checkpoint import read_checkpoint
from research.tests.baselines.test_checkpoint import Pickler, Storage, Tensor, checkpoint, no_torch

__all__ = ["no_torch"]

ROUNDS = 1000
EXTREMES = (0, 1, 0x7FFF, 0x8000, 0xFFFF, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF)


@pytest.fixture
def archive(tmp_path: Path) -> bytes:
    """A small checkpoint, of two tensors in one storage."""
    storage = Storage("FloatStorage", "0")
    tensors = {"influence_param": Tensor(storage, (3, 4), (4, 1)), "other": Tensor(storage, (2, 2), (1, 2), 3)}
    return checkpoint(tmp_path / "small.pth", tensors, {"0": np.arange(12, dtype=np.float32).tobytes()}).read_bytes()


def mutated(data: bytes, rng: np.random.Generator) -> bytes:
    """Bytes changed, cut out, doubled or cut off, and fields set to numbers at the ends of their ranges."""
    broken = bytearray(data)
    for _ in range(rng.integers(1, 4)):
        at = int(rng.integers(len(broken)))
        match rng.integers(5):
            case 0:
                broken[at] = rng.integers(256)
            case 1:
                value = EXTREMES[rng.integers(len(EXTREMES))]
                field = struct.pack("<I", value) if rng.random() < 0.5 else struct.pack("<H", value & 0xFFFF)
                broken[at : at + len(field)] = field
            case 2:
                del broken[at : at + int(rng.integers(1, 9))]
            case 3:
                broken[at:at] = broken[at : at + int(rng.integers(1, 33))]
            case _:
                if rng.random() < 0.1:
                    del broken[at:]
        if not broken:
            break
    return bytes(broken)


def headers(data: bytes) -> Iterator[tuple[int, int]]:
    """Where the archive's own records lie, which random places seldom hit."""
    for mark, size in ((b"PK\x01\x02", 46), (b"PK\x03\x04", 30), (b"PK\x05\x06", 22)):
        at = data.find(mark)
        while at >= 0:
            yield at, size
            at = data.find(mark, at + 1)


def test_mutated_archives_are_read_or_refused(archive):
    assert set(read_checkpoint(archive)) == {"influence_param"}
    rng = np.random.default_rng(0)
    said = []
    for _ in range(ROUNDS):
        try:
            read_checkpoint(mutated(archive, rng))
        except FileError as error:
            said.append(str(error))
    assert len(said) > ROUNDS / 4
    assert not [sentence for sentence in said if "\n" in sentence]


def test_every_field_of_the_archives_records_may_hold_anything(archive):
    for start, size in headers(archive):
        for at in range(start + 4, start + size, 2):
            for value in EXTREMES:
                for form in ("<H", "<I"):
                    broken = bytearray(archive)
                    field = struct.pack(form, value & (0xFFFF if form == "<H" else 0xFFFFFFFF))
                    broken[at : at + len(field)] = field
                    with suppress(FileError):
                        read_checkpoint(bytes(broken))


def test_mutated_pickles_in_sound_archives_are_read_or_refused(archive, tmp_path):
    with zipfile.ZipFile(io.BytesIO(archive)) as opened:
        pickled = opened.read("archive/data.pkl")
    rng = np.random.default_rng(1)
    for _ in range(ROUNDS):
        data = checkpoint(tmp_path / "m.pth", mutated(pickled, rng), {"0": bytes(48)}).read_bytes()
        with suppress(FileError):
            read_checkpoint(data)


@pytest.mark.parametrize("shape", [(1,), (1, 12), (2, 6)])
@pytest.mark.parametrize("stride", [2**31, 2**63 - 1, 2**63, 2**70])
@pytest.mark.parametrize("offset", [0, 2**63, 2**70])
def test_tensors_with_numbers_beyond_any_machine(shape, stride, offset, tmp_path):
    """A step that is never taken may be any number: an axis of one element."""
    buffer = io.BytesIO()
    tensor = Tensor(Storage("FloatStorage", "0"), shape, (stride,) * (len(shape) - 1) + (1,), offset)
    Pickler(buffer, protocol=2).dump({"influence_param": tensor})
    data = checkpoint(tmp_path / "m.pth", buffer.getvalue(), {"0": bytes(48)}).read_bytes()
    if offset == 0 and shape[0] == 1:
        assert read_checkpoint(data)["influence_param"].shape == shape
    else:
        with pytest.raises(FileError, match="larger than its data"):
            read_checkpoint(data)


def test_an_archive_that_points_before_its_start_is_one_sentence(archive, tmp_path, monkeypatch, capsys):
    """The central directory lies where `size` and `offset` say; too large an offset puts members before the start."""
    monkeypatch.chdir(tmp_path)
    end = archive.rindex(b"PK\x05\x06")
    offset = struct.unpack("<I", archive[end + 16 : end + 20])[0]
    (tmp_path / "kpd.pth").write_bytes(archive[: end + 16] + struct.pack("<I", offset + 1024) + archive[end + 20 :])
    assert main(["convert-kpd", "kpd.pth", "-o", "kpd.safetensors"]) == 1
    told = capsys.readouterr().err
    assert told.startswith("neuralmls: error: kpd.pth: expected a PyTorch checkpoint in the zip layout")
    assert told.count("\n") == 1
    assert not (tmp_path / "kpd.safetensors").exists()


def test_the_file_with_which_it_was_found(data, tmp_path, capsys):
    source = data / "cases" / "robustness" / "kpd_negative_seek.pth"
    if not source.is_file():
        pytest.skip(f"no {source.name} in the test data")
    assert main(["convert-kpd", str(source), "-o", str(tmp_path / "kpd.safetensors")]) == 1
    told = capsys.readouterr().err
    assert told.startswith(f"neuralmls: error: {source}: expected a PyTorch checkpoint")
    assert told.count("\n") == 1
