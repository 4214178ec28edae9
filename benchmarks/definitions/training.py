"""Training from scratch: a step of 48, width 1024, ten control points; and the whole fit of hundreds."""

from __future__ import annotations

import numpy as np

import neuralmls as nm
from benchmarks import inputs
from benchmarks.measure import Contender, interleaved
from benchmarks.row import Outcome, Row, check
from benchmarks.setting import Setting

BAR = 4.0  # times faster than PyTorch
STEPS = 48
WIDTH = 1024
LOSS = 0.2
MANY = {300: 3.0, 1000: 15.0}  # control points: seconds of a whole default fit
OWNED = 0.9  # of the weight, at a control point's own place


def run(setting: Setting) -> Outcome:
    """Against PyTorch with Adam as it comes, and with its fused Adam. Each makes its random network first."""
    shape = inputs.chair()
    steps = 8 if setting.quick else STEPS
    scaled = (shape.p - inputs.network().centre) / inputs.network().half

    def ours(_: object) -> nm.NeuralWeights:
        return nm.NeuralWeights.fit(shape.p, bounds=shape.bounds, seed=inputs.SEED, steps=steps)

    loss = inputs.weights().loss
    checked = [check(f"loss after {STEPS} steps", loss, LOSS)]
    contenders = [Contender("ours", ours)]
    if setting.has("torch"):
        from benchmarks.rivals import pytorch as rival

        for fused in (False, True):
            name = "PyTorch, fused Adam" if fused else "PyTorch"
            _, theirs = rival.train(scaled, STEPS, WIDTH, fused=fused)
            # From other random numbers: the same order, not the same digits.
            checked.append(check(f"  by {name}", theirs, LOSS))
            checked.append(check("  ratio of the two, less 1", max(loss / theirs, theirs / loss) - 1, 1.0))
            contenders.append(Contender(name, lambda _, f=fused: rival.train(scaled, steps, WIDTH, fused=f)))
    seconds = {name: total / steps for name, total in interleaved(contenders, setting.rounds).items()}
    # Each step reads and writes the middle layer and its two moments once.
    limit = 2 * 3 * WIDTH * WIDTH * 4 / setting.limits.cache
    rows = [
        Row(
            "training, a step",
            seconds["ours"],
            rival.name,
            seconds[rival.name],
            bar=setting.bar(BAR) if rival.name == "PyTorch" else None,
            limit=limit if rival.name == "PyTorch" else None,
        )
        for rival in contenders[1:]
    ] or [Row("training, a step", seconds["ours"], limit=limit)]
    for count, most in MANY.items():
        row, sure = many(setting, setting.size(count), most)
        rows.append(row)
        checked.append(sure)
    return Outcome("training", rows, checked, [])


def many(setting: Setting, count: int, most: float) -> tuple[Row, str]:
    """A fit of many control points at random in a box, until each owns its place."""
    p = np.random.default_rng(inputs.SEED).uniform(-1, 1, size=(count, 3))
    weights = nm.NeuralWeights.fit(p, seed=inputs.SEED)
    others = 1 - float(np.diagonal(nm.softmax(weights.logits(p))).min())
    ours = Contender("ours", lambda _: nm.NeuralWeights.fit(p, seed=inputs.SEED))
    seconds = interleaved([ours], setting.rounds)["ours"]
    what = f"default fit, {count} control points"
    return Row(what, seconds, bar=setting.bar(most)), check(f"{what}: what others have", others, 1 - OWNED)
