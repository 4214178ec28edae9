"""The tensors in the pickle of a PyTorch checkpoint, read as data: nothing that it names is imported or called.

A pickle is a program for a stack machine. This one knows only what PyTorch writes for tensors in dictionaries, and
what it would call are marks to it. Everything else is refused before it means anything.
"""

from __future__ import annotations

import pickletools
import warnings
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

from neuralmls.errors import FileError

# What a checkpoint may name, and the element type of each kind of storage.
STORAGES = {
    "torch FloatStorage": "<f4",
    "torch DoubleStorage": "<f8",
    "torch HalfStorage": "<f2",
    "torch LongStorage": "<i8",
    "torch IntStorage": "<i4",
    "torch ShortStorage": "<i2",
    "torch CharStorage": "i1",
    "torch ByteStorage": "u1",
    "torch BoolStorage": "?",
}
_TENSOR = "torch._utils _rebuild_tensor_v2"
_PARAMETER = "torch._utils _rebuild_parameter"
_DICT = "collections OrderedDict"
_NAMES = {*STORAGES, _TENSOR, _PARAMETER, _DICT}

_CONSTANTS: dict[str, Callable[[], Any]] = {
    "NONE": lambda: None,
    "NEWTRUE": lambda: True,
    "NEWFALSE": lambda: False,
    "EMPTY_DICT": dict,
    "EMPTY_LIST": list,
    "EMPTY_TUPLE": tuple,
}
_LITERALS = {"BININT", "BININT1", "BININT2", "LONG1", "BINFLOAT", "SHORT_BINUNICODE", "BINUNICODE", "BINUNICODE8"}
_TUPLES = {"TUPLE1": 1, "TUPLE2": 2, "TUPLE3": 3}
_MARK = object()


@dataclass(frozen=True)
class Named:
    """What a pickle wants to be imported, as `module name`."""

    name: str


@dataclass(frozen=True)
class Tensor:
    """A tensor's place in a storage: the key of that, the element type, and where each element lies."""

    key: str
    dtype: str
    offset: int
    shape: tuple[int, ...]
    strides: tuple[int, ...]


def read_pickle(data: bytes) -> Any:
    """Return what a checkpoint's pickle holds: dictionaries, lists, tuples, numbers, strings and `Tensor`.

    Raises
    ------
    FileError
        It is broken, or wants anything else to be imported or called.
    """
    machine = _Machine()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", DeprecationWarning)  # of odd backslashes in strings
            for opcode, argument, _ in pickletools.genops(data):
                if opcode.name == "STOP":
                    return machine.pop()
                machine.step(opcode.name, argument)
    except FileError:
        raise
    except (ValueError, IndexError, KeyError, TypeError, OverflowError) as error:
        raise FileError(f"its pickle is broken: {str(error)[:200]!r}") from error
    raise FileError("its pickle has no end")


class _Machine:
    def __init__(self) -> None:
        self.stack: list[Any] = []
        self.memo: dict[int, Any] = {}

    def pop(self) -> Any:
        value = self.stack.pop()
        if value is _MARK:
            raise ValueError("a mark where a value should be")
        return value

    def pop_to_mark(self) -> list[Any]:
        at = len(self.stack) - 1
        while self.stack[at] is not _MARK:
            at -= 1
            if at < 0:
                raise ValueError("a mark is missing")
        values = self.stack[at + 1 :]
        del self.stack[at:]
        return values

    def step(self, name: str, argument: Any) -> None:
        """Do one instruction."""
        push = self.stack.append
        if name in ("PROTO", "FRAME"):
            return
        if name in _CONSTANTS:
            push(_CONSTANTS[name]())
        elif name in _LITERALS:
            push(argument)
        elif name == "MARK":
            push(_MARK)
        elif name in ("BINPUT", "LONG_BINPUT"):
            self.memo[argument] = self.stack[-1]
        elif name == "MEMOIZE":
            self.memo[len(self.memo)] = self.stack[-1]
        elif name in ("BINGET", "LONG_BINGET"):
            push(self.memo[argument])
        elif name in _TUPLES:
            push(tuple(reversed([self.pop() for _ in range(_TUPLES[name])])))
        elif name == "TUPLE":
            push(tuple(self.pop_to_mark()))
        elif name in ("SETITEM", "SETITEMS"):
            self.set_items(self.pop_to_mark() if name == "SETITEMS" else [self.pop(), self.pop()][::-1])
        elif name in ("APPEND", "APPENDS"):
            values = self.pop_to_mark() if name == "APPENDS" else [self.pop()]
            _expect(self.stack[-1], list).extend(values)
        elif name == "GLOBAL":
            push(_named(argument))
        elif name == "STACK_GLOBAL":
            attribute, module = _expect(self.pop(), str), _expect(self.pop(), str)
            push(_named(f"{module} {attribute}"))
        elif name == "BINPERSID":
            push(_storage(self.pop()))
        elif name == "REDUCE":
            arguments, function = self.pop(), self.pop()
            push(_call(function, arguments))
        elif name == "BUILD":
            self.pop()  # PyTorch's notes on a dictionary
            _expect(self.stack[-1], dict)
        else:
            raise FileError(f"its pickle has the instruction {name}, which no checkpoint of tensors needs")

    def set_items(self, values: list[Any]) -> None:
        target = _expect(self.stack[-1], dict)
        if len(values) % 2:
            raise ValueError("a key without a value")
        for key, value in zip(values[::2], values[1::2], strict=True):
            if not isinstance(key, str | int):  # others could take for ever to hash
                raise ValueError("a key that is neither a name nor a number")
            target[key] = value


def _expect(value: Any, kind: type) -> Any:
    if not isinstance(value, kind):
        raise ValueError(f"expected a {kind.__name__}, found {type(value).__name__}")
    return value


def _named(name: str) -> Named:
    if name not in _NAMES:
        wanted = repr(name.replace(" ", ".")[:100])
        raise FileError(f"its pickle asks for {wanted}, and only tensors are read: nothing was executed")
    return Named(name)


def _storage(identity: Any) -> tuple[str, str]:
    kind, storage, key, *_ = _expect(identity, tuple)
    if kind != "storage" or _expect(storage, Named).name not in STORAGES:
        raise ValueError("a storage of an unknown kind")
    return _expect(key, str), STORAGES[storage.name]


def _call(function: Any, arguments: Any) -> Any:
    """What calling one of the known names would give."""
    name = _expect(function, Named).name
    if name == _DICT:
        if _expect(arguments, tuple):
            raise ValueError("a dictionary made of something")
        return {}
    if name == _PARAMETER:
        return _expect(arguments[0], Tensor)
    if name != _TENSOR:
        raise ValueError(f"a call of {name}")
    (key, dtype), offset, shape, strides, *_ = arguments
    return Tensor(key, dtype, _expect(offset, int), _whole(shape), _whole(strides))


def _whole(values: Iterable[Any]) -> tuple[int, ...]:
    return tuple(_expect(value, int) for value in _expect(values, tuple))
