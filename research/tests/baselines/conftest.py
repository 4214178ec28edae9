"""Small shapes made here, and networks of KeypointDeformer with random weights."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import neuralmls as nm
from neuralmls_research.baselines.kpd.network import shapes


@pytest.fixture
def shape(tmp_path: Path) -> Callable[..., nm.Shape]:
    """Make a shape of vertices (n, 3) and faces (f, 3), or a cloud without faces."""

    def make(vertices, faces=None) -> nm.Shape:
        if faces is None:
            path = tmp_path / "cloud.npy"
            np.save(path, np.asarray(vertices, dtype=np.float64))
            return nm.read(path)
        path = tmp_path / "mesh.obj"
        lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in np.asarray(vertices, dtype=float).tolist()]
        lines += [f"f {a} {b} {c}" for a, b, c in (np.asarray(faces) + 1).tolist()]
        path.write_text("\n".join(lines) + "\n")
        return nm.read(path)

    return make


def bar(length: int = 12, width: int = 2) -> tuple[np.ndarray, np.ndarray]:
    """A closed box of `length` x `width` x `width` squares, two triangles each."""
    grid: dict[tuple[int, ...], int] = {}
    faces = []
    size = (length, width, width)
    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        for end in (0, size[axis]):
            for i in range(size[u]):
                for j in range(size[v]):
                    corners = []
                    for di, dj in ((0, 0), (1, 0), (1, 1), (0, 1)):
                        corner = [0, 0, 0]
                        corner[axis], corner[u], corner[v] = end, i + di, j + dj
                        corners.append(grid.setdefault(tuple(corner), len(grid)))
                    a, b, c, d = corners if end else corners[::-1]
                    faces += [(a, b, c), (a, c, d)]
    return np.array(list(grid), dtype=np.float64) / length, np.array(faces)


@pytest.fixture
def a_bar(shape) -> nm.Shape:
    """A closed box of 98 + vertices, manifold and connected."""
    return shape(*bar())


@pytest.fixture
def tensors() -> dict[str, np.ndarray]:
    """A network of four keypoints with random weights."""
    rng = np.random.default_rng(7)
    return {
        name: rng.normal(size=size, scale=(np.prod(size[1:]) or 1) ** -0.5).astype(np.float32)
        for name, size in shapes(4).items()
    }
