"""A million points never seen before: tree, packing, logits, softmax, original order; and with a first frame."""

from __future__ import annotations

import numpy as np

import neuralmls as nm
from benchmarks import answers, inputs
from benchmarks.measure import Contender, interleaved
from benchmarks.row import Outcome, Row, check
from benchmarks.setting import Setting

BAR = 10.0  # times faster than PyTorch's dense logits of a tenth of the points


def run(setting: Setting) -> Outcome:
    """A million points of ours against a hundred thousand of PyTorch's."""
    n, tenth = setting.size(1_000_000), setting.size(100_000)
    x, shape = inputs.surface(n), inputs.chair()

    at = inputs.subset(2000, n)
    y = nm.Deformer(x, inputs.fresh()).deform(shape.q)
    w = nm.softmax(answers.logits(inputs.network(), x[at]))
    right, _, defined = answers.rigid(x[at], shape.p, shape.q, w)
    error = float(np.abs(y[at] - right)[defined > 1e-2].max())
    checked = [check(f"a cold frame of {n:,} points against float64", error, 1e-4)]

    def bound(weights: nm.NeuralWeights) -> nm.Deformer:
        deformer = nm.Deformer(x, weights)
        deformer.prepare()
        return deformer

    contenders = [
        Contender("ours", bound, inputs.fresh),
        Contender("frame", lambda weights: nm.Deformer(x, weights).deform(shape.q), inputs.fresh),
        Contender("tree", lambda _: inputs.tree(x)),
        Contender("logits", lambda weights: weights.logits(inputs.tree(x)), inputs.fresh),
    ]
    rival = None
    if setting.has("torch"):
        from benchmarks.definitions.logits import pytorch

        contenders.append(pytorch(inputs.surface(tenth), checked))
        rival = contenders[-1].name
    seconds = interleaved(contenders, setting.rounds)
    rows = [
        Row(
            f"logits and their softmax, cold, {n:,} points",
            seconds["ours"],
            f"{rival}, {tenth:,} points" if rival else "",
            seconds[rival] if rival else None,
            bar=setting.bar(BAR) if rival else None,
        ),
        Row("  of that: the tree", seconds["tree"]),
        Row("  of that: tree and logits", seconds["logits"]),
        Row(f"first frame, cold, {n:,} points", seconds["frame"]),
    ]
    return Outcome("cold logits", rows, checked, [])
