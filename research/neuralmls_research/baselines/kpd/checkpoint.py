"""Published checkpoints of KeypointDeformer as `.safetensors`, without running what is in them."""

from __future__ import annotations

import hashlib
import io
import math
import os
import struct
import zipfile
import zlib
from typing import Any

import numpy as np
from numpy.typing import NDArray

from neuralmls.errors import FileError, NeuralMLSError
from neuralmls.plugin import as_path, write_atomically
from neuralmls_research.baselines.checks import library
from neuralmls_research.baselines.kpd.network import checked, shapes
from neuralmls_research.baselines.kpd.pickled import Tensor, read_pickle

# What Python's zipfile raises of broken archives beside its own error: of places before the file's start, of fields cut
# short, of members that need a password, of methods that it does not know.
ZIP_ERRORS = (
    zipfile.BadZipFile, zlib.error, struct.error, ValueError, OverflowError, EOFError, OSError, RuntimeError,
)  # fmt: skip
MARK = "influence_param"  # of the dictionary that holds the network


def convert(source: str | os.PathLike[str], target: str | os.PathLike[str]) -> int:
    """Write the network of a PyTorch checkpoint as a `.safetensors` file; return the number of its keypoints.

    The checkpoint's pickle is read as data: nothing that it names is imported or called.

    Raises
    ------
    FileError
        The checkpoint is missing, broken, no PyTorch zip file, holds anything but tensors in dictionaries, or no
        KeypointDeformer; the target cannot be written, and is then as it was.
    NeuralMLSError
        safetensors is not installed.
    """
    path = as_path("source", source)
    try:
        data = path.read_bytes()
    except OSError as error:
        raise FileError(f"{path}: cannot read: {error.strerror or error}") from error
    try:
        tensors = read_checkpoint(data)
        count = len(checked(tensors)[MARK])
    except NeuralMLSError as error:
        raise FileError(f"{path}: {error}") from error
    wanted = {name: np.ascontiguousarray(tensors[name]) for name in shapes(count)}
    notes = {"source_sha256": hashlib.sha256(data).hexdigest()}
    write_atomically(target, library("safetensors.numpy").save(wanted, notes))
    return count


def read_checkpoint(data: bytes) -> dict[str, NDArray[Any]]:
    """Return the network's tensors in the bytes of a checkpoint, by name.

    Raises
    ------
    FileError
        As for `convert`.
    """
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            return _tensors(archive)
    except FileError:
        raise
    except ZIP_ERRORS as error:
        raise FileError(
            f"expected a PyTorch checkpoint in the zip layout (1.6 or later): {error or 'it is broken'}"
        ) from error


def _tensors(archive: zipfile.ZipFile) -> dict[str, NDArray[Any]]:
    pickles = [name for name in archive.namelist() if name.count("/") == 1 and name.endswith("/data.pkl")]
    if len(pickles) != 1:
        raise FileError(f"expected a PyTorch checkpoint, with one data.pkl in it, found {len(pickles)}")
    folder = pickles[0].removesuffix("data.pkl")
    order = f"{folder}byteorder"
    if order in archive.namelist() and _member(archive, order) != b"little":
        raise FileError("expected a checkpoint of a little-endian machine")
    network = _find(read_pickle(_member(archive, pickles[0])))
    if network is None:
        raise FileError(f"expected a dictionary of tensors with '{MARK}', found none: this is no KeypointDeformer")
    return {  # only those that are needed: a file can name its data as often as it likes
        name: _array(archive, f"{folder}data/{value.key}", name, value)
        for name in shapes(1)
        if isinstance(value := network.get(name), Tensor)
    }


def _member(archive: zipfile.ZipFile, name: str) -> bytes:
    """The bytes of a member, which PyTorch never compresses: so none is larger than the file."""
    try:
        info = archive.getinfo(name)
    except KeyError:
        raise FileError(f"expected a member '{name}' in the checkpoint, found none") from None
    if info.compress_type != zipfile.ZIP_STORED:
        raise FileError(f"expected the member '{name}' not to be compressed, as PyTorch writes it")
    return archive.read(info)


def _find(root: Any) -> dict[Any, Any] | None:
    """The dictionary that has the network's tensors, in whatever others it lies."""
    waiting, seen = [root], set()
    for value in waiting:  # which grows
        if isinstance(value, dict) and id(value) not in seen:
            if MARK in value:
                return value
            seen.add(id(value))
            waiting.extend(value.values())
    return None


def _array(archive: zipfile.ZipFile, member: str, name: str, tensor: Tensor) -> NDArray[Any]:
    data = _member(archive, member)
    if len(data) % np.dtype(tensor.dtype).itemsize:
        raise FileError(f"the data of the tensor '{name}', {len(data)} bytes, are no whole number of its elements")
    storage = np.frombuffer(data, dtype=tensor.dtype)
    if not 1 <= len(tensor.shape) == len(tensor.strides) <= 8 or min(tensor.shape) < 1 or min(tensor.strides) < 0:
        raise FileError(f"the tensor '{name}' has no valid shape")
    last = tensor.offset + sum((n - 1) * step for n, step in zip(tensor.shape, tensor.strides, strict=True))
    if tensor.offset < 0 or last >= storage.size or math.prod(tensor.shape) > storage.size:
        raise FileError(f"the tensor '{name}' is larger than its data, {storage.size} numbers")
    # The step along an axis of one element is never taken, and may be any number.
    steps = [step * storage.itemsize if n > 1 else 0 for n, step in zip(tensor.shape, tensor.strides, strict=True)]
    return np.lib.stride_tricks.as_strided(storage[tensor.offset :], tensor.shape, steps, writeable=False).copy()
