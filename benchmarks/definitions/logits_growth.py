"""Warm logits of 100k and of 1M points: ten times the points must not take ten times as long."""

from __future__ import annotations

import numpy as np

from benchmarks import inputs
from benchmarks.measure import Contender, interleaved
from benchmarks.row import Outcome, Row, check
from benchmarks.setting import Setting

BAR = 2.0  # times the time


def run(setting: Setting) -> Outcome:
    """Ourselves at a million points against ourselves at a hundred thousand."""
    many, few = setting.size(1_000_000), setting.size(100_000)
    x = inputs.surface(many)
    weights = inputs.weights()
    trees = {n: inputs.tree(x[:n]) for n in (few, many)}
    apart = np.abs(weights.logits(trees[many])[:few] - weights.logits(trees[few])).max()
    checked = [check("the same points among others have the same logits", float(apart), 2e-4)]
    seconds = interleaved(
        [Contender(f"{n}", lambda _, t=tree: weights.logits(t)) for n, tree in trees.items()], 2 * setting.rounds
    )
    row = Row(
        f"logits, {many:,} points",
        seconds[f"{many}"],
        f"ours, {few:,} points",
        seconds[f"{few}"],
        sense="times",
        bar=setting.bar(BAR),
    )
    return Outcome("growth of warm logits", [row], checked, [])
