"""Logits of 10k, 100k and 1M points, the tree built: the network evaluated again after a fit."""

from __future__ import annotations

import numpy as np

from benchmarks import answers, crossing, inputs
from benchmarks.measure import Contender, interleaved, once
from benchmarks.rivals import dense_numpy
from benchmarks.row import Outcome, Row, check
from benchmarks.setting import Setting

BARS = {10_000: 20.0, 100_000: 120.0}  # times faster than PyTorch
SAMPLE = 2000
DENSE = 2e-3  # of rivals, whose sums in single precision are longer
LARGEST = 100_000  # points in one batch; a million would take 8 GB for the activations of the two hidden layers
LARGE_CHUNK = 8192


def run(setting: Setting) -> Outcome:
    """Against PyTorch (the better of one batch and chunks), NumPy, and our own dense path."""
    rows: list[Row] = []
    checked: list[str] = []
    for full in (10_000, 100_000, 1_000_000):
        contenders = contenders_for(setting.size(full), setting, checked)
        seconds = interleaved(contenders, setting.rounds)
        limit: float | None = limit_for(setting.size(full), setting)
        for rival in [contender.name for contender in contenders[1:]]:
            bar = BARS.get(full) if rival.startswith("PyTorch") else None
            rows.append(
                Row(
                    f"logits, {setting.size(full):,} points",
                    seconds["ours"],
                    rival,
                    seconds[rival],
                    bar=None if bar is None else setting.bar(bar),
                    limit=limit,
                )
            )
            limit = None  # once
    return Outcome("logits", rows, checked, [])


def contenders_for(n: int, setting: Setting, checked: list[str]) -> list[Contender]:
    """Ourselves first; every answer held against float64."""
    x, network = inputs.surface(n), inputs.network()
    weights, dense = inputs.weights(), inputs.dense()
    tree = inputs.tree(x)
    scaled = ((x - network.centre) / network.half).astype(np.float32)
    at = inputs.subset(SAMPLE, n)
    truth = answers.logits(network, x[at])

    def hold(name: str, found: np.ndarray, tolerance: float) -> None:
        checked.append(check(f"logits of {n:,} points by {name}", float(np.abs(found - truth).max()), tolerance))

    hold("us against float64", weights.logits(tree)[at], 1e-4)
    hold("NumPy", dense_numpy.logits(network, scaled[at]), DENSE)
    hold("our own dense path", dense.logits(x[at]), DENSE)
    contenders = [
        Contender("ours", lambda _: weights.logits(tree)),
        Contender("NumPy", lambda _: dense_numpy.logits(network, scaled)),
        Contender("own dense path", lambda _: dense.logits(x)),
    ]
    if setting.has("torch"):
        contenders.insert(1, pytorch(x, checked))
    return contenders


def pytorch(x: np.ndarray, checked: list[str]) -> Contender:
    """PyTorch's best way for so many points, each tried twice."""
    from benchmarks.rivals import pytorch as rival

    network = inputs.network()
    net, points = rival.loaded(network), rival.points(network, x)
    at = inputs.subset(SAMPLE, len(x))
    error = float(np.abs(rival.logits(net, points[at], len(at)).numpy() - answers.logits(network, x[at])).max())
    checked.append(check(f"logits of {len(x):,} points by PyTorch", error, DENSE))
    chunks = [chunk for chunk in rival.CHUNKS if chunk < len(x)] + [len(x)]
    if len(x) > LARGEST:
        chunks = [LARGE_CHUNK]
    tried = {
        chunk: min(once(Contender("", lambda _, size=chunk: rival.logits(net, points, size))) for _ in range(2))
        for chunk in chunks
        if len(chunks) > 1
    }
    best = min(tried, key=lambda chunk: tried[chunk]) if tried else chunks[0]
    name = "PyTorch, one batch" if best == len(x) else f"PyTorch, by {best}"
    return Contender(name, lambda _: rival.logits(net, points, best))


def limit_for(n: int, setting: Setting) -> float:
    """The crossing neurons' operations at the peak, or the bytes of points and logits, whichever takes longer."""
    work = crossing.work(inputs.network(), inputs.surface(n))
    moved = n * (3 * 8 + 4 * len(inputs.chair().p))
    return max(setting.limits.compute(work.in_leaves + work.in_boxes), moved / setting.limits.memory)
