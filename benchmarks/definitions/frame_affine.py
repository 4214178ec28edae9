"""Affine moving least squares with classic weights 1/d^2, from points to points in one call: 100k points."""

from __future__ import annotations

import numpy as np

import neuralmls as nm
from benchmarks import inputs
from benchmarks.measure import Contender, interleaved
from benchmarks.row import Outcome, Row, check
from benchmarks.setting import Setting


def run(setting: Setting) -> Outcome:
    """Against molesq. Our frame alone, the weights given, stands beside it."""
    shape, x = inputs.chair(), inputs.surface(setting.size(100_000))
    p, q = shape.p, shape.q
    weights = nm.InverseDistanceWeights(p)
    y = nm.Deformer(x, weights, transform="affine").deform(q)

    at = inputs.subset(2000, len(x))
    checked = [check(f"affine positions of {len(x):,} points against float64", apart(y[at], naive(x[at], p, q)), 1e-5)]
    bound = nm.Deformer(x, weights, transform="affine")
    out = np.empty_like(x)
    contenders = [
        Contender("ours", lambda _: nm.Deformer(x, weights, transform="affine").deform(q)),
        Contender("frame", lambda _: bound.deform(q, 1.0, out=out)),
    ]
    if setting.has("molesq"):
        from benchmarks.rivals import affine_molesq as rival

        checked.append(check("  by molesq", apart(rival.affine(x[at], p, q), y[at]), 1e-5))
        contenders.append(Contender("molesq", lambda _: rival.affine(x, p, q)))
    seconds = interleaved(contenders, setting.rounds)
    rows = [
        Row(f"classic affine, {len(x):,} points", seconds["ours"], *_rival(seconds)),
        Row("  of that: the frame", seconds["frame"]),
    ]
    return Outcome("affine frame", rows, checked, [])


def naive(x: np.ndarray, p: np.ndarray, q: np.ndarray) -> np.ndarray:
    """Affine moving least squares by its formula (Schaefer et al. 2006, equation 5)."""
    w = 1 / ((x[:, None] - p) ** 2).sum(axis=2)
    w /= w.sum(axis=1, keepdims=True)
    p_star, q_star = w @ p, w @ q
    a, b = p - p_star[:, None], q - q_star[:, None]
    matrix = np.linalg.solve(np.einsum("nm,nmi,nmj->nij", w, a, a), np.einsum("nm,nmi,nmj->nij", w, a, b))
    y: np.ndarray = np.einsum("ni,nij->nj", x - p_star, matrix) + q_star
    return y


def apart(a: np.ndarray, b: np.ndarray) -> float:
    """The largest difference."""
    return float(np.abs(a - b).max())


def _rival(seconds: dict[str, float]) -> tuple[str, float | None]:
    return ("molesq", seconds["molesq"]) if "molesq" in seconds else ("", None)
