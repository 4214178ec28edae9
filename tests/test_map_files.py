"""Saved maps: the same bits back, and one sentence for whatever else a file may hold."""

from __future__ import annotations

import io
import json
import pickle
import struct
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import neuralmls as nm

P = np.array([[-1.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
X = np.random.default_rng(0).uniform(-1, 1, (50, 3))


def saved(folder: Path, weights: str = "neural", **parameters: Any) -> bytes:
    points = nm.ControlPoints(P, P + 0.1)
    nm.Session(points, weights=weights, **parameters).fit(X).save(folder / "a.map")  # type: ignore[arg-type]
    return (folder / "a.map").read_bytes()


@pytest.fixture(scope="module")
def good(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    return saved(tmp_path_factory.mktemp("maps"), width=16, steps=5)


def parts(data: bytes) -> tuple[dict[str, Any], bytes]:
    """The header of a safetensors file, and its arrays."""
    (length,) = struct.unpack("<Q", data[:8])
    return json.loads(data[8 : 8 + length]), data[8 + length :]


def joined(header: dict[str, Any], arrays: bytes) -> bytes:
    text = json.dumps(header).encode()
    return struct.pack("<Q", len(text)) + text + arrays


def changed(data: bytes, name: str, **entries: Any) -> bytes:
    header, arrays = parts(data)
    header[name] |= entries
    return joined(header, arrays)


def refused(folder: Path, data: bytes) -> str:
    (folder / "bad.map").write_bytes(data)
    for load in (nm.Map.load, nm.NeuralWeights.load):
        with pytest.raises(nm.FileError) as caught:
            load(folder / "bad.map")
        sentence = str(caught.value)
        assert sentence.startswith(f"{folder / 'bad.map'}: ")
        assert sentence.isprintable()
        assert len(sentence) < len(str(folder)) + 400
    return sentence


@pytest.mark.parametrize("weights", ["neural", "shape-aware", "inverse-distance"])
def test_a_saved_map_is_the_same_bits(weights, tmp_path):
    first = saved(tmp_path, weights)
    loaded = nm.Map.load(tmp_path / "a.map")
    loaded.save(tmp_path / "b.map")
    assert (tmp_path / "b.map").read_bytes() == first
    assert loaded.session.weights == weights
    fitted = nm.Session(nm.ControlPoints(P, P + 0.1), weights=weights).fit(X)
    assert np.array_equal(loaded.at(X), fitted.at(X))


@pytest.mark.parametrize("length", [0, 1, 7, 8, 9, 100, -1, -100])
def test_a_file_cut_short_is_refused(good, length, tmp_path):
    refused(tmp_path, good[:length])


def test_what_follows_the_end_is_refused(good, tmp_path):
    refused(tmp_path, good + b"\0")


@pytest.mark.parametrize(
    "name", ["control_points", "centre", "weight0", "weight1", "bias2", "losses", "loss", "frequencies"]
)
def test_an_array_that_is_missing_or_of_another_type_or_shape_is_refused(good, name, tmp_path):
    header, arrays = parts(good)
    entry = header[name]
    others = {key: value for key, value in header.items() if key != name}
    refused(tmp_path, joined(others, arrays))
    other = "F32" if entry["dtype"] == "F64" else "I32"
    size = {"F64": 8, "F32": 4, "I32": 4}
    last = [*entry["shape"][:-1], entry["shape"][-1] * size[entry["dtype"]] // size[other]]
    refused(tmp_path, changed(good, name, dtype=other, shape=last))
    refused(tmp_path, changed(good, name, shape=[*entry["shape"], 1]))
    if len(set(entry["shape"])) == 2 and name != "frequencies":
        refused(tmp_path, changed(good, name, shape=entry["shape"][::-1]))


@pytest.mark.parametrize(
    ("name", "entries"),
    [
        ("weight1", {"shape": [2**32, 2**32]}),
        ("weight1", {"shape": [-1, 16]}),
        ("weight1", {"data_offsets": [0, 2**63]}),
        ("weight1", {"data_offsets": [8, 0]}),
        ("weight1", {"dtype": "object"}),
    ],
)
def test_sizes_that_cannot_be_are_refused_without_taking_memory_for_them(good, name, entries, tmp_path):
    refused(tmp_path, changed(good, name, **entries))


def test_a_header_that_claims_to_be_huge_is_refused(tmp_path):
    for length in (2**64 - 1, 2**40, 10**8):
        refused(tmp_path, struct.pack("<Q", length) + b"{}")


@pytest.mark.parametrize("value", [np.nan, np.inf])
@pytest.mark.parametrize("name", ["control_points", "weight1", "bias0", "centre", "half", "loss"])
def test_numbers_that_are_not_finite_are_refused(good, name, value, tmp_path):
    header, arrays = parts(good)
    begin = header[name]["data_offsets"][0]
    number = struct.pack("<d" if header[name]["dtype"] == "F64" else "<f", value)
    refused(tmp_path, joined(header, arrays[:begin] + number + arrays[begin + len(number) :]))


def said(data: bytes, **entries: Any) -> bytes:
    """The file with other metadata."""
    header, arrays = parts(data)
    metadata = json.loads(header["__metadata__"]["neuralmls-map"])
    header["__metadata__"]["neuralmls-map"] = json.dumps(metadata | entries)
    return joined(header, arrays)


@pytest.mark.parametrize(
    "metadata",
    [{"version": 2}, {"version": "1"}, {"weights": "magic"}, {"weights": "inverse-distance"}, {"weights": 1}],
)
def test_metadata_of_something_else_is_refused(good, metadata, tmp_path):
    refused(tmp_path, said(good, **metadata))


@pytest.mark.parametrize("metadata", [{}, {"format": "pt"}, {"neuralmls-map": ""}, {"neuralmls-map": "[1]"}])
def test_a_file_of_another_program_is_refused(good, metadata, tmp_path):
    header, arrays = parts(good)
    refused(tmp_path, joined({**header, "__metadata__": metadata}, arrays))


def test_a_session_that_does_not_belong_to_the_weights_is_refused(good, tmp_path):
    header, _ = parts(good)
    session = json.loads(header["__metadata__"]["neuralmls-map"])["session"]
    moved = json.loads(json.dumps(session))
    moved["control_points"][0]["position"] = [5, 5, 5]
    other = json.loads(json.dumps(session))
    other["settings"]["weights"] = {"kind": "inverse-distance"}
    for wrong in (None, "", {}, [], moved, other):
        (tmp_path / "bad.map").write_bytes(said(good, session=wrong))
        with pytest.raises(nm.FileError, match=r"bad\.map: "):
            nm.Map.load(tmp_path / "bad.map")


class Bomb:
    """Says so if it is ever unpickled."""

    def __reduce__(self) -> tuple[Any, ...]:
        return pytest.fail, ("a pickle was executed",)


def archive() -> bytes:
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as packed:
        packed.writestr("archive/data.pkl", bytes(1 << 20))
    return file.getvalue()


def arrays_of_numpy() -> bytes:
    file = io.BytesIO()
    np.savez(file, weight0=np.zeros((2, 2)))
    return file.getvalue()


@pytest.mark.parametrize(
    "data",
    [b"\x93NUMPY\x01\0", archive(), arrays_of_numpy(), pickle.dumps(Bomb()), b"\x80\x04" * 40, bytes(100), b"{}" * 50],
    ids=["npy", "zip", "npz", "pickle", "pickle-like", "zeros", "json"],
)
def test_files_of_other_kinds_are_refused_and_nothing_is_executed(data, tmp_path):
    refused(tmp_path, data)


def test_a_folder_a_pipe_and_nothing_are_refused(tmp_path):
    for name, sentence in (("", "cannot read: Is a directory"), ("none.map", "none.map: there is no such file")):
        with pytest.raises(nm.FileError, match=sentence):
            nm.Map.load(tmp_path / name)
