"""What shape-aware weights are taught, in Rust, against the formula by NumPy and SciPy (studies/shape_logits.py)."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import neuralmls as nm
from neuralmls import _core

STUDIES = Path(__file__).resolve().parents[1] / "studies"
NO_FACES = np.empty((0, 3), dtype=np.uint32)


@pytest.fixture
def twin(monkeypatch: pytest.MonkeyPatch) -> Any:
    """The logits by NumPy: (x, faces, p) -> nodes, logits there."""
    pytest.importorskip("scipy")
    monkeypatch.syspath_prepend(str(STUDIES))
    from shape_logits import shape_logits
    from surface_graph import SurfaceGraph

    def found(x: Any, faces: Any, p: Any) -> tuple[Any, Any]:
        graph = SurfaceGraph(x, faces)
        return graph.nodes, shape_logits(graph, p, distances=graph.distances(p))

    return found


def mesh() -> tuple[Any, Any]:
    """A sheet with waves; no two of its distances are the same."""
    rng = np.random.default_rng(3)
    u, v = np.meshgrid(np.linspace(-1, 1, 21), np.linspace(-0.6, 0.6, 13), indexing="ij")
    x = np.stack([u, v, 0.3 * np.sin(3 * u)], axis=2).reshape(-1, 3) + rng.uniform(-0.01, 0.01, (21 * 13, 3))
    a = (np.arange(20)[:, None] * 13 + np.arange(12)).reshape(-1)
    return x, np.concatenate([np.stack([a, a + 13, a + 14], axis=1), np.stack([a, a + 14, a + 1], axis=1)])


def soup() -> tuple[Any, Any]:
    """Its triangles each by itself, some twice, and a needle; two sheets of them that touch."""
    x, faces = mesh()
    rng = np.random.default_rng(4)
    turned = x[:, [1, 0, 2]] * [0.9, 0.7, -0.8] + [0.05, 0.1, 0.35] + rng.uniform(-0.003, 0.003, x.shape)
    torn = np.concatenate([x[faces].reshape(-1, 3), turned[faces[::2]].reshape(-1, 3), x[faces[:9]].reshape(-1, 3)])
    needle = np.array([[-1.0, -0.6, 0.4], [1.0, 0.61, 0.42], [0.1, 0.02, 0.4101]])
    torn = np.concatenate([torn, needle])
    return torn, np.arange(len(torn)).reshape(-1, 3)


def cloud() -> tuple[Any, None]:
    """Points without a face."""
    return np.random.default_rng(5).uniform(-1, 1, (600, 3)) * [1, 0.5, 0.2], None


@pytest.mark.parametrize("shape", [mesh, soup, cloud])
def test_labels_are_those_of_the_formula(shape: Any, twin: Any) -> None:
    x, faces = shape()
    p = x[nm.farthest_of(x, 7)] + np.random.default_rng(6).uniform(-0.02, 0.02, (7, 3))  # beside the surface
    triangles = NO_FACES if faces is None else np.ascontiguousarray(faces, dtype=np.uint32)
    places, logits = _core.Weights.labels(p, np.array([[-1.0, -1, -1], [1, 1, 1]]), (x, triangles))
    nodes, expected = twin(x, faces, p)
    away = np.linalg.norm(places[:, None] - nodes[None], axis=2)
    which = away.argmin(axis=1)
    assert len(places) == min(2048, len(nodes))
    assert away.min(axis=1).max() < 1e-9
    assert np.abs(logits - expected[which]).max() < 1e-6
