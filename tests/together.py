"""A body, its shirt, landmarks and a badge, whose points partly coincide: files that one map has to keep together."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import neuralmls as nm

Array = NDArray[np.float64]

FILES = ("body.obj", "shirt.ply", "badge.npy", "landmarks.csv")
SOURCES = [
    [0, 1.75, 0],
    [0, 1.3, 0.05],
    [0, 0.9, 0],
    [0.55, 1.4, 0],
    [-0.55, 1.4, 0],
    [0.15, 0, 0.05],
    [-0.15, 0, 0.05],
]
TARGETS = [
    [0.1, 1.8, 0.1],
    [0, 1.3, 0.05],
    [0, 0.9, 0],
    [0.5, 1.7, 0.2],
    [-0.5, 1.1, 0.1],
    [0.2, 0, 0.3],
    [-0.15, 0, 0.05],
]
NAMES = ["head", "chest", "hips", "left-hand", "right-hand", "left-foot", "right-foot"]


def control_points() -> nm.ControlPoints:
    return nm.ControlPoints(SOURCES, TARGETS, NAMES)


def write(folder: Path) -> None:
    """Write FILES. The shirt's even rows are vertices of the body; so are the landmarks, and a corner of the badge."""
    body, faces = _tube(rows=160, around=90, low=0.0, high=1.8)
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in body.tolist()]
    lines += [f"f {a} {b} {c}" for a, b, c in (faces + 1).tolist()]
    (folder / "body.obj").write_text("\n".join(lines) + "\n")

    rows = body.reshape(160, 90, 3)[90:135].copy()
    rows[1::2] *= [1.05, 1, 1.1]  # odd rows stand off the body
    shirt = rows.reshape(-1, 3)
    header = f"ply\nformat binary_little_endian 1.0\nelement vertex {len(shirt)}\n"
    header += "".join(f"property double {axis}\n" for axis in "xyz") + "end_header\n"
    (folder / "shirt.ply").write_bytes(header.encode() + shirt.astype("<f8").tobytes())

    steps = np.stack(np.meshgrid(*[np.linspace(0, 0.03, 5)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    np.save(folder / "badge.npy", body[90 * 120 + 7] + steps)

    chosen = np.arange(0, len(body), 97)
    text = [f"mark {i},{x!r},{y!r},{z!r},{i % 3},by hand" for i, (x, y, z) in enumerate(body[chosen].tolist())]
    (folder / "landmarks.csv").write_text("\n".join(["name,x,y,z,side,how", *text]) + "\n")


def _tube(*, rows: int, around: int, low: float, high: float) -> tuple[Array, NDArray[np.int64]]:
    """A tube, wider at half of its height, in coordinates that no power of two divides."""
    height, angle = np.meshgrid(np.linspace(low, high, rows), np.arange(around) * (2 * np.pi / around), indexing="ij")
    radius = 0.2 + 0.1 * np.sin(np.pi * height / high) ** 2
    x = np.stack([1.3 * radius * np.cos(angle), height, radius * np.sin(angle)], axis=-1).round(7)
    index = np.arange(rows * around).reshape(rows, around)
    a, b, c, d = index[:-1], np.roll(index[:-1], -1, 1), np.roll(index[1:], -1, 1), index[1:]
    return x.reshape(-1, 3), np.stack([a, b, c, a, c, d], axis=-1).reshape(-1, 3)


def apart(before: Mapping[str, Array], after: Mapping[str, Array]) -> float:
    """How far points that coincided are apart at most, in the greatest motion of any."""
    ended: dict[tuple[float, ...], list[Array]] = {}
    motion = 0.0
    for name, x in before.items():
        motion = max(motion, float(np.linalg.norm(after[name] - x, axis=1).max()))
        for place, end in zip(map(tuple, x.tolist()), after[name], strict=True):
            ended.setdefault(place, []).append(end)
    shared = [np.stack(ends) for ends in ended.values() if len(ends) > 1]
    assert len(shared) > 1000
    return max(float(np.ptp(ends, axis=0).max()) for ends in shared) / motion
