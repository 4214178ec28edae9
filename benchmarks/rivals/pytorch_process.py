"""The work of `neuralmls deform` as a script on PyTorch: read an OBJ, train, evaluate, move, write.

Started as `python pytorch_process.py IN.obj POINTS.json OUT.obj`. It reads only the vertices, and carries every other
line over.
"""

from __future__ import annotations

import json
import sys

import torch
from torch import nn

STEPS, WIDTH, CHUNK = 48, 1024, 8192


def main(source: str, points: str, target: str) -> None:
    torch.set_num_threads(2)
    torch.manual_seed(0)
    with open(source) as file:
        lines = file.readlines()
    at = [i for i, line in enumerate(lines) if line.startswith("v ")]
    x = torch.tensor([[float(number) for number in lines[i].split()[1:4]] for i in at])
    with open(points) as file:
        control_points = json.load(file)["control_points"]
    p = torch.tensor([point["position"] for point in control_points])
    q = torch.tensor([point.get("target", point["position"]) for point in control_points])
    low, high = x.min(dim=0).values, x.max(dim=0).values
    centre, half = (low + high) / 2, (high - low).max() / 2

    net = nn.Sequential(nn.Linear(3, WIDTH), nn.ReLU(), nn.Linear(WIDTH, WIDTH), nn.ReLU(), nn.Linear(WIDTH, len(p)))
    adam = torch.optim.Adam(net.parameters(), lr=6e-4)
    inputs, classes = (p - centre) / half, torch.arange(len(p))
    for step in range(STEPS):
        if step == STEPS * 4 // 5:
            adam.param_groups[0]["lr"] = 6e-5
        adam.zero_grad()
        nn.functional.cross_entropy(net(inputs), classes).backward()
        adam.step()

    with torch.inference_mode():
        logits = torch.cat([net((part - centre) / half) for part in x.split(CHUNK)])
        w = torch.softmax(logits, dim=1)
        p_star, q_star = w @ p, w @ q
        c = (w[:, :, None] * (p - p_star[:, None])).transpose(1, 2) @ (q - q_star[:, None])
        u, _, vt = torch.linalg.svd(c)
        sign = torch.ones(len(x), 1, 3)
        sign[:, 0, 2] = torch.sign(torch.linalg.det(u) * torch.linalg.det(vt))
        rotation = vt.transpose(1, 2) * sign @ u.transpose(1, 2)
        y = (rotation @ (x - p_star)[:, :, None])[:, :, 0] + q_star

    for i, (a, b, c) in zip(at, y.tolist(), strict=True):
        lines[i] = f"v {a:.6f} {b:.6f} {c:.6f}\n"
    with open(target, "w") as file:
        file.writelines(lines)


if __name__ == "__main__":
    main(*sys.argv[1:])
