"""PyTorch, the way the published NeuralMLS code works: a dense MLP, Adam on the full batch, batched SVD."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import torch
from numpy.typing import NDArray
from torch import nn

from benchmarks.inputs import Network
from benchmarks.threads import THREADS

torch.set_num_threads(THREADS)
CHUNKS = (4096, 8192, 16384, 32768)


def product(size: int) -> Callable[[], object]:
    """A matrix product to measure the machine by."""
    a, out = torch.ones(size, size), torch.empty(size, size)
    return lambda: torch.mm(a, a, out=out)


def module(width: int, m: int) -> nn.Sequential:
    """The untrained network."""
    return nn.Sequential(nn.Linear(3, width), nn.ReLU(), nn.Linear(width, width), nn.ReLU(), nn.Linear(width, m))


def loaded(network: Network) -> nn.Sequential:
    """The network with given parameters."""
    made = module(len(network.layers[0][1]), len(network.layers[2][1]))
    with torch.no_grad():
        for layer, (weight, bias) in zip(made[::2], network.layers, strict=True):
            layer.weight.copy_(torch.from_numpy(weight))
            layer.bias.copy_(torch.from_numpy(bias))
    return made


def points(network: Network, x: NDArray[np.float64]) -> torch.Tensor:
    """Points as the network takes them."""
    return torch.from_numpy(((x - network.centre) / network.half).astype(np.float32))


@torch.inference_mode()
def logits(net: nn.Sequential, x: torch.Tensor, chunk: int) -> torch.Tensor:
    """Logits, `chunk` points at a time."""
    if chunk >= len(x):
        return net(x)
    return torch.cat([net(part) for part in x.split(chunk)])


def train(p: NDArray[np.float64], steps: int, width: int, *, fused: bool) -> tuple[nn.Sequential, float]:
    """Train from scratch, and return the loss after the last step."""
    x = torch.from_numpy(p.astype(np.float32))
    classes = torch.arange(len(p))
    net = module(width, len(p))
    adam = torch.optim.Adam(net.parameters(), lr=6e-4, fused=fused)
    for step in range(steps):
        if step == steps * 4 // 5:
            adam.param_groups[0]["lr"] = 6e-5
        adam.zero_grad()
        nn.functional.cross_entropy(net(x), classes).backward()
        adam.step()
    with torch.inference_mode():
        return net, float(nn.functional.cross_entropy(net(x), classes))


@torch.inference_mode()
def rigid(x: torch.Tensor, p: torch.Tensor, q: torch.Tensor, w: torch.Tensor) -> torch.Tensor:
    """One frame of a drag, its weights given."""
    p_star, q_star = w @ p, w @ q
    p_hat, q_hat = p - p_star[:, None], q - q_star[:, None]
    c = (w[:, :, None] * p_hat).transpose(1, 2) @ q_hat
    u, _, vt = torch.linalg.svd(c)
    sign = torch.ones(len(x), 1, 3)
    sign[:, 0, 2] = torch.sign(torch.linalg.det(u) * torch.linalg.det(vt))
    rotation = vt.transpose(1, 2) * sign @ u.transpose(1, 2)
    return (rotation @ (x - p_star)[:, :, None])[:, :, 0] + q_star
