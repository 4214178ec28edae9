"""What the machine is, and what it can do at most: multiplications and bytes a second, measured now."""

from __future__ import annotations

import os
import platform
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version
from time import perf_counter

import numpy as np

from benchmarks.rivals import installed
from benchmarks.threads import THREADS
from neuralmls_research.experiments.reproduce.provenance import processor

SQUARE = 2048  # a matrix product of this size does little but multiply
DRAM = 1 << 28  # bytes: far beyond any cache
MIDDLE = 3 * 4 << 20  # bytes: a middle layer of 1024 x 1024 and its two moments

_pool = ThreadPoolExecutor(THREADS)


@dataclass(frozen=True)
class Limits:
    """Of all threads together."""

    flops: float  # a second, float32; by the best sgemm of the libraries here, which comes near the FMA units' peak
    memory: float  # bytes a second, read and written, DRAM
    cache: float  # the same for what training streams

    def compute(self, flops: float) -> float:
        """The least seconds that so many operations take."""
        return flops / self.flops


def limits(*, quick: bool) -> Limits:
    """Measure them: the best of several tries, because a limit is what the machine can do when left alone."""
    tries = 3 if quick else 15
    return Limits(_sgemm(tries), _copy(DRAM >> 4 if quick else DRAM, tries), _update(MIDDLE, 4 * tries))


def move(read: np.ndarray, source: np.ndarray, target: np.ndarray) -> None:
    """Read one array and copy another, on all threads: the bytes of a frame, and nothing else."""

    def part(index: int) -> None:
        def cut(array: np.ndarray) -> np.ndarray:
            return array[index * len(array) // THREADS : (index + 1) * len(array) // THREADS]

        cut(read).max()
        np.copyto(cut(target), cut(source))

    list(_pool.map(part, range(THREADS)))


def describe() -> dict[str, str | int]:
    """What the record says of the machine."""
    facts: dict[str, str | int] = {
        "cpu": processor(),
        "cores": os.cpu_count() or 0,
        "threads": THREADS,
        "system": f"{platform.system()} {platform.machine()}",
        "python": platform.python_version(),
    }
    if hasattr(os, "getloadavg"):
        facts["load before"] = f"{os.getloadavg()[0]:.2f}"
    for name in ("neuralmls", "numpy", "torch", "molesq"):
        try:
            facts[name] = version(name)
        except PackageNotFoundError:
            facts[name] = "not installed"
    return facts


def _best(work: Callable[[], object], tries: int) -> float:
    work()
    seconds = []
    for _ in range(tries):
        start = perf_counter()
        work()
        seconds.append(perf_counter() - start)
    return min(seconds)


def _sgemm(tries: int) -> float:
    a = np.ones((SQUARE, SQUARE), np.float32)
    out = np.empty_like(a)
    seconds = _best(lambda: np.matmul(a, a, out=out), tries)
    if installed("torch"):
        from benchmarks.rivals import pytorch

        seconds = min(seconds, _best(pytorch.product(SQUARE), tries))
    return 2 * SQUARE**3 / seconds


def _copy(size: int, tries: int) -> float:
    nothing, source, target = np.ones(THREADS), np.ones(size // 8), np.zeros(size // 8)
    return 2 * size / _best(lambda: move(nothing, source, target), tries)


def _update(size: int, tries: int) -> float:
    array = np.ones(size // 4, np.float32)
    parts = np.array_split(array, THREADS)
    return 2 * size / _best(lambda: list(_pool.map(lambda part: np.negative(part, out=part), parts)), tries)
