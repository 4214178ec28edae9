"""The right answers, plainly, in double precision."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from benchmarks.inputs import Network

Array = NDArray[np.float64]


def logits(network: Network, x: Array) -> Array:
    """The network evaluated layer by layer."""
    h = (x - network.centre) / network.half
    for weight, bias in network.layers[:2]:
        h = np.maximum(h @ weight.T.astype(np.float64) + bias, 0)
    weight, bias = network.layers[2]
    out: Array = h @ weight.T.astype(np.float64) + bias
    return out


def rigid(x: Array, p: Array, q: Array, w: Array) -> tuple[Array, Array, Array]:
    """Rigid moving least squares (Zhu, Gortler 2007) by SVD: positions, rotations, and how well defined each is.

    The last is (s2 +- s3) / s1 of C: at 0 any of several rotations is as good.
    """
    p_star, q_star = w @ p, w @ q
    c = np.einsum("nm,nmi,nmj->nij", w, p - p_star[:, None], q - q_star[:, None])
    u, s, vt = np.linalg.svd(c)
    sign = np.sign(np.linalg.det(u) * np.linalg.det(vt))
    u[:, :, 2] *= sign[:, None]
    rotation = np.einsum("nji,nkj->nik", vt, u)
    y = np.einsum("nij,nj->ni", rotation, x - p_star) + q_star
    return y, rotation, (s[:, 1] + sign * s[:, 2]) / s[:, 0]
