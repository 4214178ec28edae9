"""NumPy in single precision: the network as three matrix products, the frame by batched SVD."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from benchmarks.inputs import Network

Single = NDArray[np.float32]
CHUNK = 8192  # points at a time: their activations stay in the caches


def logits(network: Network, x: Single) -> Single:
    """Logits of points already centred and scaled."""
    (w0, b0), (w1, b1), (w2, b2) = network.layers
    out = np.empty((len(x), len(b2)), np.float32)
    for start in range(0, len(x), CHUNK):
        h = x[start : start + CHUNK] @ w0.T
        h += b0
        h = np.maximum(h, 0, out=h) @ w1.T
        h += b1
        out[start : start + CHUNK] = np.maximum(h, 0, out=h) @ w2.T + b2
    return out


def rigid(x: Single, p: Single, q: Single, w: Single) -> Single:
    """One frame of a drag, its weights given."""
    p_star, q_star = w @ p, w @ q
    c = np.swapaxes(w[:, :, None] * (p - p_star[:, None]), 1, 2) @ (q - q_star[:, None])
    u, _, vt = np.linalg.svd(c)
    u[:, :, 2] *= np.sign(np.linalg.det(u) * np.linalg.det(vt))[:, None]
    rotation = np.swapaxes(u @ vt, 1, 2)
    y: Single = (rotation @ (x - p_star)[:, :, None])[:, :, 0] + q_star
    return y
