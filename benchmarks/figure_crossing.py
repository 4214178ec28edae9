"""Draws docs/crossing-neurons.png: `python -m benchmarks.figure_crossing`."""

from __future__ import annotations

from pathlib import Path

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
import numpy as np
from PIL import Image

from benchmarks import inputs
from benchmarks.crossing import crossing

CELLS = 72  # along the chair's height
TARGET = Path(__file__).resolve().parents[1] / "docs" / "crossing-neurons.png"


def main() -> None:
    """Two maps of a slice through the chair's middle, and the mean along the kd-tree of a million points."""
    figure, (left, middle, right) = plt.subplots(
        1, 3, figsize=(12, 4.4), width_ratios=(1, 1, 1.3), layout="constrained"
    )
    counts, extent = slice_counts()
    on_slice = inputs.surface(400_000)
    on_slice = on_slice[np.abs(on_slice[:, 0] - inputs.chair().p[0, 0]) < 0.02]
    for axes, count, name in zip((left, middle), counts, ("first", "second"), strict=True):
        image = axes.imshow(count, origin="lower", extent=extent, cmap="magma", vmin=0)
        axes.plot(on_slice[::6, 2], on_slice[::6, 1], ",", color="white", alpha=0.5)
        axes.set(title=f"{name} layer: of 1,024 neurons\ncross zero in a cell", xlabel="z", ylabel="y")
        figure.colorbar(image, ax=axes, shrink=0.85)
    sizes, means = along_the_tree(inputs.surface(1_000_000))
    for values, name, style in zip(means.T, ("first layer", "second layer"), ("o-", "s--"), strict=True):
        right.plot(sizes, values, style, label=name)
    right.set(xscale="log", yscale="log", xlabel="points in a box of the tree", ylabel="neurons that cross zero")
    right.set_title("down the tree of 1,000,000 points")
    right.invert_xaxis()
    right.grid(alpha=0.3)
    right.legend()
    figure.savefig(TARGET, dpi=110)
    Image.open(TARGET).convert("RGB").quantize(128).save(TARGET, optimize=True)
    print(f"{TARGET}: {TARGET.stat().st_size / 1000:.0f} kB; cells {counts.mean(axis=(1, 2))}; leaf {means[-1]}")


def slice_counts() -> tuple[np.ndarray, tuple[float, float, float, float]]:
    """Crossing neurons of both layers in each cubic cell of a slice through a leg, (2, y, z)."""
    shape, network = inputs.chair(), inputs.network()
    low, high = shape.bounds
    side = (high[1] - low[1]) / CELLS
    ys = np.arange(low[1] + side / 2, high[1], side)
    zs = np.arange(low[2] + side / 2, high[2], side)
    half = np.full(3, side / 2 / network.half)
    counts = np.empty((2, len(ys), len(zs)))
    for i, y in enumerate(ys):
        for j, z in enumerate(zs):
            centre = (np.array([shape.p[0, 0], y, z]) - network.centre) / network.half
            counts[:, i, j] = [mask.sum() for mask in crossing(network, centre, half)]
    return counts, (zs[0] - side / 2, zs[-1] + side / 2, ys[0] - side / 2, ys[-1] + side / 2)


def along_the_tree(x: np.ndarray, paths: int = 12, leaf: int = 16) -> tuple[np.ndarray, np.ndarray]:
    """Mean crossing neurons by depth, along random paths of a kd-tree: points in a box, and (depth, 2)."""
    network, rng = inputs.network(), np.random.default_rng(0)
    scaled = (x - network.centre) / network.half
    sizes, found = [], []
    for _ in range(paths):
        points, line = scaled, []
        sizes = []
        while len(points) >= leaf:
            low, high = points.min(axis=0), points.max(axis=0)
            line.append([mask.sum() for mask in crossing(network, (low + high) / 2, (high - low) / 2)])
            sizes.append(len(points))
            order = np.argpartition(points[:, int((high - low).argmax())], len(points) // 2)
            points = points[order[: len(points) // 2] if rng.random() < 0.5 else order[len(points) // 2 :]]
        found.append(line)
    depth = min(len(line) for line in found)
    return np.array(sizes[:depth]), np.mean([line[:depth] for line in found], axis=0)


if __name__ == "__main__":
    main()
