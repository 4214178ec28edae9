"""What is timed, one definition a file; each has `run(size) -> Outcome`, and they run in this order."""

from __future__ import annotations

from collections.abc import Callable

from benchmarks.definitions import (
    editor,
    exact,
    frame_affine,
    frame_rigid,
    growth,
    logits,
    logits_cold,
    logits_growth,
    million,
    process,
    relax,
    shape_aware,
    training,
)
from benchmarks.row import Outcome
from benchmarks.setting import Setting

Definition = Callable[[Setting], Outcome]

ALL: dict[str, Definition] = {
    "editor": editor.run,  # first: a browser feels what ran before it
    "logits": logits.run,
    "logits-cold": logits_cold.run,
    "logits-growth": logits_growth.run,
    "frame-rigid": frame_rigid.run,
    "frame-affine": frame_affine.run,
    "training": training.run,
    "process": process.run,
    "million": million.run,
    "growth": growth.run,
    "exact": exact.run,
    "shape-aware": shape_aware.run,
    "relax": relax.run,
}
