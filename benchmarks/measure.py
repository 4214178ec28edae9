"""Interleaved timing: in every round each contender has its turn, so that what else the machine does hits all alike."""

from __future__ import annotations

import gc
from collections.abc import Callable
from dataclasses import dataclass, field
from statistics import median
from time import perf_counter
from typing import Any

SHORT = (
    0.2  # seconds; what is done sooner is called once untimed first, because the one before left its data in the caches
)
CALLS = 5  # timed calls of a short contender in a round
BUDGET = 8.0  # seconds; a contender that has used them takes no further turns (a dense million: after its first)


@dataclass
class Contender:
    """Something timed. `call` is given what `prepare` returns, which is not timed."""

    name: str
    call: Callable[[Any], object]
    prepare: Callable[[], Any] = field(default=lambda: None)


def interleaved(contenders: list[Contender], rounds: int) -> dict[str, float]:
    """Return the median seconds of each contender, by name."""
    samples: dict[str, list[float]] = {contender.name: [] for contender in contenders}
    for _ in range(rounds):
        for contender in contenders:
            taken = samples[contender.name]
            if sum(taken) > BUDGET:
                continue
            first = once(contender)
            taken += [first] if first > SHORT else [once(contender) for _ in range(CALLS)]
    return {name: median(taken) for name, taken in samples.items()}


def once(contender: Contender) -> float:
    """Seconds of one call."""
    given = contender.prepare()
    gc.disable()
    try:
        start = perf_counter()
        result = contender.call(given)
        seconds = perf_counter() - start
    finally:
        gc.enable()
    del result  # freeing it is not timed
    return seconds
