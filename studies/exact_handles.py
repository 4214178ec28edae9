"""What exact handles change: `python -m studies.exact_handles FOLDER [--figures FOLDER]`, two minutes.

FOLDER has the paper's chairs and airplanes in `shapenet/` (they are not ours to give). Every case is deformed twice
with the same weights, soft and exact, also where control points own less and less of their places: by that the limit of
`ExactHandles.aim_carefully` was chosen (crates/core/src/aim). Prints the tables of docs/notes/beyond-the-paper.md; its
pictures are of our own sample shapes.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from statistics import median

import numpy as np
from numpy.typing import NDArray

import neuralmls as nm
from neuralmls import samples
from neuralmls_research.experiments.published import published
from neuralmls_research.metrics import measure

Array = NDArray[np.float64]

SHAPES = ("ShapeNetPlane1", "ShapeNetPlane2", "ShapeNetChair1", "ShapeNetChair3", "chair2")
PAPER, OURS, PUBLISHED = (
    "the paper's width of 1024, the published code's 48 steps",
    "our default: each owns 0.9",
    "published code: width 128",
)
TRAININGS: dict[str, dict[str, int]] = {PAPER: {"steps": 48}, OURS: {}, PUBLISHED: {"steps": 48, "width": 128}}
# Weights that own less and less: our training at higher temperatures, the published width trained for longer.
OWNING: list[tuple[dict[str, int], float]] = [
    *(({}, temperature) for temperature in (1.0, 1.5, 2.0, 3.0)),
    *(({"width": 128, "steps": steps}, 1.0) for steps in (48, 100, 200)),
]
BANDS = (0.0, 0.16, 0.25, 0.5, 0.7, 0.85, 1.0)
ARRIVED = 1e-6

HEAD = (
    "| case | least own weight | worst handle error, % of the box | curvature, mean | median | Dirichlet, mean "
    "| median | vertices folded |\n|---|---|---|---|---|---|---|---|"
)


@dataclass(frozen=True)
class Case:
    """A shape, and where its control points go."""

    title: str
    shape: nm.Shape
    p: Array
    q: Array

    @property
    def side(self) -> float:
        """The longest side of the shape's box, in file units."""
        return float(np.ptp(self.shape.bounds, axis=0).max())


@dataclass(frozen=True)
class Result:
    """What a deformation does; the error in parts of the box's longest side."""

    error: float
    curvature: float
    curvature_median: float
    dirichlet: float
    dirichlet_median: float
    folded: int


def cases(data: Path) -> Iterator[Case]:
    """Every published displacement that moves a control point."""
    for name in SHAPES:
        found = published(data, name)
        if found is None:
            raise SystemExit(f"{data}: expected the paper's shapes, but there is no shapenet/{name}")
        for displacement, points in found.displacements.items():
            if (points.sources != points.targets).any():
                yield Case(f"{name}, {displacement}", found.shape, points.sources, points.targets)


def result(case: Case, weights: nm.NeuralWeights, adherence: float, temperature: float = 1.0) -> Result:
    """Deform a case, and measure what came of it."""

    def f(x: Array) -> Array:
        return np.asarray(nm.Deformer(x, weights).deform(case.q, temperature, adherence=adherence))

    found = measure(case.shape.positions, f(case.shape.positions), case.shape.faces, case.p, case.q, f=f)
    return Result(
        error=float(np.linalg.norm(f(case.p) - case.q, axis=1).max()) / case.side,
        curvature=found.curvature.mean,
        curvature_median=found.curvature.median,
        dirichlet=found.strain.dirichlet_mean,
        dirichlet_median=found.strain.dirichlet_median,
        folded=found.folded,
    )


def compared(case: Case, training: dict[str, int]) -> tuple[Result, Result]:
    """Print a line of the table; return what soft and exact handles do."""
    weights = nm.NeuralWeights.fit(case.p, bounds=case.shape.bounds, **training)
    own = float(np.diagonal(nm.softmax(weights.logits(case.p))).min())
    soft, exact = (result(case, weights, adherence) for adherence in (0.0, 1.0))
    cells = [f"{100 * soft.error:.2f} / {100 * exact.error:.1g}"]
    for name, digits in (("curvature", 4), ("curvature_median", 3), ("dirichlet", 4), ("dirichlet_median", 4)):
        cells.append(f"{getattr(soft, name):.{digits}g} / {getattr(exact, name):.{digits}g}")
    print(f"| {case.title} | {own:.2f} | {' | '.join(cells)} | {soft.folded} / {exact.folded} |")
    return soft, exact


def summary(pairs: list[tuple[Result, Result]]) -> str:
    """What exact handles change in the middle of all cases, and at the most."""
    said = [f"worst handle error {max(exact.error for _, exact in pairs):.1e} of the box"]
    for name in ("curvature", "curvature_median", "dirichlet", "dirichlet_median"):
        ratios = [getattr(exact, name) / getattr(soft, name) for soft, exact in pairs]
        said.append(f"{name} exact / soft {median(ratios):.3f} in the median ({min(ratios):.3f} to {max(ratios):.3f})")
    return "; ".join(said)


def owning(everything: list[Case]) -> str:
    """The table of exact / soft by how much the control points own of their places, the least of them."""
    found: list[tuple[float, Result, Result]] = []
    for case in everything:
        for training, temperature in OWNING:
            weights = nm.NeuralWeights.fit(case.p, bounds=case.shape.bounds, **training)
            own = float(np.diagonal(nm.softmax(weights.logits(case.p), temperature)).min())
            found.append((own, *(result(case, weights, adherence, temperature) for adherence in (0.0, 1.0))))
    lines = [
        "| least own weight | cases | do not arrive | fold | curvature, mean | curvature, median |",
        "|---|---|---|---|---|---|",
    ]
    for low, high in pairwise(BANDS):
        band = [each for each in found if low <= each[0] < high]
        owned = [own for own, _, _ in band]
        cells = [f"{min(owned):.2f} to {max(owned):.2f}", str(len(band))]
        cells.append(str(sum(exact.error > ARRIVED for _, _, exact in band)))
        cells.append(str(sum(exact.folded > soft.folded for _, soft, exact in band)))
        for name in ("curvature", "curvature_median"):
            ratios = [getattr(exact, name) / getattr(soft, name) for _, soft, exact in band]
            cells.append(f"{median(ratios):.2f}, {max(ratios):.2f}")
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)


def figures(folder: Path) -> None:
    """Draw our own chair, where exact handles mend weights that own little, and our own car, where they cannot."""
    from neuralmls.figures.render import Panel, render

    for name, columns in (("chair", 4), ("car", 2)):
        sample = samples.make(name)
        x, points = sample.vertices, sample.control_points
        bounds = np.stack([x.min(axis=0), x.max(axis=0)])
        panels = [Panel("at rest", x, sample.triangles)]
        for training, adherence in ((PUBLISHED, 0.0), (PUBLISHED, 1.0), (OURS, 1.0)):
            weights = nm.NeuralWeights.fit(points.sources, bounds=bounds, **TRAININGS[training])
            y = nm.Deformer(x, weights).deform(points.targets, adherence=adherence)
            panels.append(
                Panel(f"{'exact' if adherence else 'soft'}, {training.partition(':')[0]}", y, sample.triangles)
            )
        path = folder / f"exact-handles-{name}.png"
        render(panels, path, control_points=points, width=1000, columns=columns)


def main() -> None:
    """Print the tables, and draw the pictures if asked to."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--figures", type=Path, help="the folder to draw the pictures into")
    given = parser.parse_args()
    everything = list(cases(given.folder))
    for title, training in TRAININGS.items():
        print(f"**{title}** (soft / exact)\n\n{HEAD}")
        pairs = [compared(case, training) for case in everything]
        print(f"\n{summary(pairs)}\n", flush=True)
    print(f"**By what control points own** (exact / soft)\n\n{owning(everything)}\n", flush=True)
    if given.figures is not None:
        figures(given.figures)


if __name__ == "__main__":
    main()
