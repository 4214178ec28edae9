"""One rigid frame of a drag, the weights given: 100k and 1M points."""

from __future__ import annotations

import numpy as np

import neuralmls as nm
from benchmarks import answers, inputs, machine
from benchmarks.measure import Contender, interleaved
from benchmarks.rivals import dense_numpy
from benchmarks.row import Outcome, Row, check
from benchmarks.setting import Setting

FASTER = 350.0  # than PyTorch, 100k points
MOVING = 3.0  # times the time of moving its bytes, 1M points
SAMPLE = 20_000


def run(setting: Setting) -> Outcome:
    """Against PyTorch and NumPy with batched SVD, and against moving the bytes of the frame."""
    rows, checked = [], []
    shape = inputs.chair()
    p, q = shape.p, shape.q
    for full in (100_000, 1_000_000):
        n = setting.size(full)
        x = inputs.surface(n)
        logits = inputs.weights().logits(x)
        deformer = nm.Deformer(x, inputs.Given(p, logits))

        at = inputs.subset(SAMPLE, n)
        w = nm.softmax(logits[at])
        right, rotations, defined = answers.rigid(x[at], p, q, w)
        y, maps = deformer.deform(q, return_maps=True)
        clear = defined > 1e-3
        if clear.mean() < 0.5:
            raise RuntimeError("fewer than half of the points have a well-defined rotation: nothing is checked")
        off = float(np.abs(maps[at] - rotations)[clear].max())
        checked.append(check(f"rotations of {n:,} points against float64", off, 1e-5))
        checked.append(check("  positions", float(np.abs(y[at] - right)[clear].max()), 1e-4))

        single = [array.astype(np.float32) for array in (x, p, q, nm.softmax(logits))]
        out = np.empty_like(x)
        target = np.empty_like(x)
        contenders = [
            Contender("ours", lambda _, d=deformer, o=out: d.deform(q, 1.0, out=o)),
            Contender("its bytes moved", lambda _, a=logits, b=x, c=target: machine.move(a, b, c)),
            Contender("NumPy, SVD", lambda _, s=single: dense_numpy.rigid(*s)),
        ]
        error = dense_numpy.rigid(single[0][at], single[1], single[2], single[3][at]) - right
        checked.append(check("  positions by NumPy", float(np.abs(error)[defined > 1e-2].max()), 1e-3))
        if setting.has("torch"):
            contenders.append(pytorch(single, at, right, defined, checked))
        seconds = interleaved(contenders, setting.rounds)
        moving = seconds["its bytes moved"]
        for contender in reversed(contenders[1:]):
            rival = contender.name
            bytes_moved = rival == "its bytes moved"
            bar = MOVING if bytes_moved and full == 1_000_000 else None
            if rival.startswith("PyTorch") and full == 100_000:
                bar = FASTER
            rows.append(
                Row(
                    f"rigid frame, {n:,} points",
                    seconds["ours"],
                    rival,
                    seconds[rival],
                    sense="times" if bytes_moved else "faster",
                    bar=None if bar is None else setting.bar(bar),
                    limit=moving if bytes_moved else None,
                )
            )
    return Outcome("rigid frame", rows, checked, [])


def pytorch(
    single: list[np.ndarray], at: np.ndarray, right: np.ndarray, defined: np.ndarray, checked: list[str]
) -> Contender:
    """PyTorch, its answer checked where single precision is enough for it."""
    import torch

    from benchmarks.rivals import pytorch as rival

    tensors = [torch.from_numpy(array) for array in single]
    error = rival.rigid(*tensors).numpy()[at] - right
    checked.append(check("  positions by PyTorch", float(np.abs(error)[defined > 1e-2].max()), 1e-3))
    return Contender("PyTorch, SVD", lambda _: rival.rigid(*tensors))
