"""Checkpoints become `.safetensors`, and nothing that they name is imported or called."""

from __future__ import annotations

import io
import os
import pickle
import sys
import types
import zipfile
from collections import OrderedDict
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest

from neuralmls.cli import main
from neuralmls.errors import FileError
from neuralmls_research.baselines.kpd import KeypointDeformer
from neuralmls_research.baselines.kpd.checkpoint import convert, read_checkpoint
from neuralmls_research.baselines.kpd.pickled import read_pickle

OTHER = "influence_predictor.1.0.linear.weight"


class Storage:
    """Stands for a storage of PyTorch's: its kind, and the name of its data in the file."""

    def __init__(self, kind: str, key: str) -> None:
        self.kind, self.key = kind, key


def named(module: str, name: str) -> object:
    """What pickles as a name of PyTorch's, which need not be installed."""
    if module not in sys.modules:
        sys.modules[module] = types.ModuleType(module)
    stand_in = type(name, (), {"__module__": module, "__qualname__": name, "__call__": None})
    setattr(sys.modules[module], name, stand_in)
    return stand_in


class Tensor:
    """Pickles as PyTorch's tensors do."""

    def __init__(self, storage, shape, strides, offset=0) -> None:
        self.arguments = (storage, offset, shape, strides, False, OrderedDict())

    def __reduce__(self):
        return named("torch._utils", "_rebuild_tensor_v2"), self.arguments


class Pickler(pickle.Pickler):
    def persistent_id(self, value):
        if isinstance(value, Storage):
            return ("storage", named("torch", value.kind), value.key, "cpu", 1)
        return None


@pytest.fixture(autouse=True)
def no_torch(monkeypatch):
    """The stand-ins for PyTorch's names are gone after each test."""
    for module in ("torch", "torch._utils"):
        monkeypatch.setitem(sys.modules, module, types.ModuleType(module))


def checkpoint(path: Path, content: object, data: dict[str, bytes], compression: int = zipfile.ZIP_STORED) -> Path:
    """Write a file laid out as PyTorch's are."""
    pickled = content
    if not isinstance(content, bytes):
        buffer = io.BytesIO()
        Pickler(buffer, protocol=2).dump(content)
        pickled = buffer.getvalue()
    with zipfile.ZipFile(path, "w", compression) as archive:
        archive.writestr("archive/data.pkl", pickled)
        archive.writestr("archive/byteorder", b"little")
        for key, values in data.items():
            archive.writestr(f"archive/data/{key}", values)
    return path


def stored(tensors) -> tuple[OrderedDict[str, Tensor], dict[str, bytes]]:
    """Tensors as PyTorch stores them, each in a storage of its own."""
    states, data = OrderedDict(), {}
    for i, (name, values) in enumerate(tensors.items()):
        strides = tuple(step // values.itemsize for step in values.strides)
        states[name] = Tensor(Storage("FloatStorage", str(i)), values.shape, strides)
        data[str(i)] = values.tobytes()
    states._metadata = {"": {"version": 1}}  # which PyTorch adds, and a pickle builds
    return states, data


def test_a_checkpoint_of_tensors_gives_a_network_that_is_the_same(tensors, tmp_path, a_bar):
    states, data = stored(tensors)
    source = checkpoint(tmp_path / "kpd.pth", states, data)
    assert convert(source, tmp_path / "kpd.safetensors") == 4
    read = KeypointDeformer.read(tmp_path / "kpd.safetensors").bind(a_bar)
    assert np.array_equal(read.influence, KeypointDeformer(tensors).bind(a_bar).influence)


def test_the_network_is_found_among_an_optimiser_and_settings(tensors, tmp_path):
    states, data = stored(tensors)
    other = {"epoch": 7, "loss": 0.5, "big": 2**70, "done": True, "none": None, "list": [1, (2, 3, 4, 5)], "states": {}}
    source = checkpoint(tmp_path / "kpd.pth", {**other, "models": {"net": states}}, data)
    found = read_checkpoint(source.read_bytes())
    assert all(np.array_equal(found[name], values) for name, values in tensors.items())


def test_strided_tensors_of_a_shared_storage_are_laid_out(tmp_path):
    numbers = np.arange(24, dtype=np.float32)
    storage = Storage("FloatStorage", "0")
    states = {"influence_param": Tensor(storage, (3, 4), (1, 3), 5), OTHER: Tensor(storage, (2, 5), (0, 2))}
    found = read_checkpoint(checkpoint(tmp_path / "a.pth", states, {"0": numbers.tobytes()}).read_bytes())
    assert np.array_equal(found["influence_param"], numbers[5:17].reshape(4, 3).T)
    assert np.array_equal(found[OTHER], [numbers[:10:2]] * 2)


@pytest.mark.parametrize("protocol", range(6))
@pytest.mark.parametrize(
    "call",
    [(os.system, "touch ran"), (eval, "open('ran', 'w')"), (exec, "open('ran', 'w')"), (__import__, "antigravity")],
)
def test_hostile_pickles_are_refused_in_one_sentence_and_not_executed(protocol, call, tmp_path, monkeypatch, capsys):
    class Hostile:
        def __reduce__(self):
            return call[0], (call[1],)

    monkeypatch.chdir(tmp_path)
    hostile = pickle.dumps({"influence_param": Hostile()}, protocol=protocol)
    checkpoint(tmp_path / "kpd.pth", hostile, {})
    assert main(["convert-kpd", "kpd.pth", "-o", "kpd.safetensors"]) == 1
    ran = capsys.readouterr()
    assert ran.err.startswith("neuralmls: error: kpd.pth: its pickle ")
    assert ran.err.count("\n") == 1
    assert ran.out == ""
    assert sorted(path.name for path in tmp_path.iterdir()) == ["kpd.pth"]
    assert "antigravity" not in sys.modules


@pytest.mark.parametrize(
    "pickled",
    [
        b"cos\nsystem\n(S'touch ran'\ntR.",
        b"(S'touch ran'\nios\nsystem\n.",  # INST
        b"\x80\x02(cos\nsystem\nX\x09\x00\x00\x00touch rano.",  # OBJ
        b"\x80\x04\x8c\x02os\x8c\x06system\x93\x8c\x09touch ran\x85R.",  # STACK_GLOBAL
        b"\x80\x02\x82\x01.",  # an extension's code
        b"\x80\x02ctorch._utils\n_rebuild_tensor_v2\n)\x81.",  # NEWOBJ
        b"\x80\x02ccollections\nOrderedDict\n)R}X\x09\x00\x00\x00__class__cos\nsystem\nsb.",
    ],
)
def test_every_way_to_a_call_is_closed(pickled, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(FileError, match="its pickle "):
        read_pickle(pickled)
    assert not list(tmp_path.iterdir())


def test_every_broken_pickle_is_refused(tensors, tmp_path):
    buffer = io.BytesIO()
    Pickler(buffer, protocol=2).dump(stored({"influence_param": tensors["influence_param"]})[0])
    whole = buffer.getvalue()
    read_pickle(whole)
    for end in range(len(whole)):
        with pytest.raises(FileError):
            read_pickle(whole[:end])
    rng = np.random.default_rng(0)
    for _ in range(3000):
        broken = bytearray(whole)
        for at in rng.integers(len(whole), size=rng.integers(1, 4)):
            broken[at] = rng.integers(256)
        with suppress(FileError):
            read_pickle(bytes(broken))


def test_a_pickle_of_tuples_in_tuples_is_no_key(tmp_path):
    doubled = b"\x80\x02)" + b"q\x00h\x00\x86" * 60  # 2^60 of them, if one were to hash it
    with pytest.raises(FileError, match="neither a name nor a number"):
        read_pickle(b"\x80\x02}" + doubled[2:] + b"K\x01s.")
    with pytest.raises(FileError, match="expected a str"):
        read_pickle(doubled + b"h\x00\x93.")


def test_a_dictionary_that_holds_itself_many_times_is_searched_once(tmp_path):
    itself: dict[str, object] = {}
    itself.update({str(i): itself for i in range(20_000)})
    with pytest.raises(FileError, match="this is no KeypointDeformer"):
        read_checkpoint(checkpoint(tmp_path / "kpd.pth", itself, {}).read_bytes())


@pytest.mark.parametrize(
    ("tensor", "words"),
    [
        (Tensor(Storage("FloatStorage", "0"), (2, 4), (4, 1)), "larger than its data"),
        (Tensor(Storage("FloatStorage", "0"), (2, 2), (2, 1), 1), "larger than its data"),
        (Tensor(Storage("FloatStorage", "0"), (2**62, 2**62), (0, 0)), "larger than its data"),
        (Tensor(Storage("FloatStorage", "0"), (2, 2), (-2, 1), 2), "no valid shape"),
        (Tensor(Storage("FloatStorage", "0"), (2, 2), (2,)), "no valid shape"),
        (Tensor(Storage("FloatStorage", "0"), (0, 2**70), (1, 1)), "no valid shape"),
        (Tensor(Storage("FloatStorage", "0"), (1, 1), (1, 1), -1), "larger than its data"),
        (Tensor(Storage("FloatStorage", "1"), (2, 2), (2, 1)), "member 'archive/data/1'"),
        (Tensor(Storage("FloatStorage", "../0"), (2, 2), (2, 1)), "expected a member"),
        (Tensor(Storage("QUInt8Storage", "0"), (2, 2), (2, 1)), "torch.QUInt8Storage"),
        (Tensor(Storage("DoubleStorage", "0"), (2, 2), (2, 1)), "larger than its data"),
    ],
)
def test_tensors_that_point_elsewhere_are_refused(tensor, words, tmp_path):
    source = checkpoint(tmp_path / "kpd.pth", {"influence_param": tensor}, {"0": bytes(16)})
    with pytest.raises(FileError) as caught:
        convert(source, tmp_path / "kpd.safetensors")
    assert str(caught.value).startswith(f"{source}: ")
    assert words in str(caught.value)
    assert not (tmp_path / "kpd.safetensors").exists()


def test_data_that_is_no_whole_number_of_elements_is_refused(tmp_path):
    states = {"influence_param": Tensor(Storage("FloatStorage", "0"), (1,), (1,))}
    with pytest.raises(FileError, match="bytes"):
        read_checkpoint(checkpoint(tmp_path / "kpd.pth", states, {"0": bytes(7)}).read_bytes())


def test_compressed_members_are_refused_before_they_are_unpacked(tmp_path):
    bomb = checkpoint(tmp_path / "kpd.pth", {}, {"0": bytes(10**6)}, zipfile.ZIP_DEFLATED)
    with pytest.raises(FileError, match="not to be compressed"):
        read_checkpoint(bomb.read_bytes())


def test_files_that_are_no_checkpoints_are_refused(tmp_path):
    plain = checkpoint(tmp_path / "kpd.pth", {"a": 1}, {}).read_bytes()
    with pytest.raises(FileError, match="this is no KeypointDeformer"):
        read_checkpoint(plain)
    other = io.BytesIO()
    with zipfile.ZipFile(other, "w") as archive:
        archive.writestr("readme.txt", "hello")
    for data in (b"", b"\x80\x02\x8a\nl\xfc\x9cF\xf9 j\xa8P\x19.", plain[:100], other.getvalue()):
        with pytest.raises(FileError, match="expected a PyTorch checkpoint"):
            read_checkpoint(data)


def test_the_command_says_what_it_wrote_and_keeps_what_is_there(tensors, tmp_path, capsys):
    source, target = checkpoint(tmp_path / "kpd.pth", *stored(tensors)), tmp_path / "kpd.safetensors"
    assert main(["convert-kpd", str(source), "-o", str(target)]) == 0
    assert capsys.readouterr().out == f"{target}: KeypointDeformer with 4 keypoints\n"
    written = target.read_bytes()
    assert main(["convert-kpd", str(source), "-o", str(target)]) == 2
    assert "there is such a file already" in capsys.readouterr().err
    assert main(["convert-kpd", str(tmp_path / "none.pth"), "-o", str(target), "--force"]) == 1
    assert target.read_bytes() == written
    assert main(["convert-kpd", str(source), "-o", str(tmp_path / "kpd.npz")]) == 2
