"""Figure 3: the method at a glance, every picture of it an intermediate result of one real run."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from numpy.typing import NDArray

from neuralmls import ControlPoints, Deformer, NeuralWeights, softmax
from neuralmls.figures.palette import heat
from neuralmls.figures.render import Panel, render
from neuralmls_research.experiments.reproduce import verdicts
from neuralmls_research.experiments.reproduce.drawing import COLOURS, NEURAL, plots
from neuralmls_research.experiments.reproduce.lab import Lab
from neuralmls_research.experiments.reproduce.outcomes import STEPS
from neuralmls_research.experiments.reproduce.report import Claim, Conclusions, Picture, Report
from neuralmls_research.experiments.reproduce.subjects import Subject, chair

Array = NDArray[np.float64]

FILE = "fig3-overview.png"
SHARE = 0.5  # of the weight at its own place, by which a control point counts as learned
CAPTION = (
    "From left to right: control points on the shape; the network, which learns from them alone which is which (below, "
    "the chance that it gives each control point at its own place); what it says of each vertex of the control point "
    "that moves furthest, its logit (colours from the least to the largest); the weight, which the softmax makes of "
    "the logits (0 to 1); whose weight is largest, a colour for each control point; and what moving least squares "
    "makes of the weights and the targets."
)


def run(lab: Lab) -> Report:
    """Run the method step by step, and draw each step."""
    subject = chair(lab)
    p, q = subject.points.sources, subject.points.targets
    fits = [NeuralWeights.fit(p, bounds=subject.bounds, width=lab.width, steps=STEPS, seed=seed) for seed in lab.seeds]
    own = [np.diag(softmax(fit.logits(p))).astype(np.float64) for fit in fits]
    logits = fits[0].logits(subject.positions).astype(np.float64)
    w = np.asarray(softmax(logits), dtype=np.float64)
    y = np.asarray(Deformer(subject.positions, fits[0]).deform(q), dtype=np.float64)
    chosen = int(np.linalg.norm(q - p, axis=1).argmax())
    _draw(lab, subject, chosen, logits, w, y, own[0])
    learned = verdicts.above(SHARE, [float(values.min()) for values in own])
    apart = float(np.abs(w.sum(axis=1) - 1).max())
    return Report(
        f"{subject.label}, {len(subject.positions):,} vertices, {len(p)} control points; network 3, {lab.width}, "
        f"{lab.width}, {len(p)}; {STEPS} steps, T = 1, rigid; {len(lab.seeds)} seeds, of which the first is drawn.",
        pictures=[Picture(FILE, CAPTION)],
        claims=[
            Claim(
                paper="The network is trained, with cross-entropy, to tell each control point from the others; its "
                "softmax is the weight.",
                measure="The least weight that a control point has at its own place, after training.",
                measured=f"Least over {len(p)} control points, by seed: "
                f"{', '.join(f'{values.min():.2f}' for values in own)}. A vertex's weights sum to 1 to {apart:.0e}.",
                ruling=learned,
                conclusions=Conclusions(
                    "The pipeline is as drawn: shape and targets are not part of the training.",
                    "It depends on the seed whether the network has learned all control points.",
                    "The network has not learned its control points.",
                ),
            )
        ],
        numbers={"weight_at_own_place": [values.tolist() for values in own], "moves_furthest": chosen},
        missing=subject.missing,
    )


def _draw(lab: Lab, subject: Subject, chosen: int, logits: Array, w: Array, y: Array, own: Array) -> None:
    """Each step as a panel; arrows between them."""
    x, faces, points = subject.positions, subject.faces, subject.points
    column = logits[:, chosen]
    of_all = np.array([_rgb(COLOURS[i % len(COLOURS)]) for i in range(w.shape[1])])[w.argmax(axis=1)]
    still = ControlPoints(points.sources, points.sources)
    shapes = [
        ("control points", Panel("", x, faces, subject.colours), still),
        ("logits of one", Panel("", x, faces, heat((column - column.min()) / np.ptp(column))), still),
        ("weights: softmax(logits / T)", Panel("", x, faces, weights=w[:, chosen]), still),
        ("whose is largest", Panel("", x, faces, of_all), still),
        ("result of MLS", Panel("", y, faces, subject.colours), ControlPoints(points.targets, points.targets)),
    ]
    pictures = [_picture(lab, subject, panel, moved) for _, panel, moved in shapes]
    titles = [title for title, _, _ in shapes]
    with plots(lab, FILE, 1, len(shapes) + 1, (15.5, 3.9), width_ratios=[1, 0.9, 1, 1, 1, 1]) as axes:
        for ax in axes[0]:
            ax.set_axis_off()
        for number, (ax, picture, title) in enumerate(zip(np.delete(axes[0], 1), pictures, titles, strict=True)):
            ax.imshow(picture)
            ax.set_title(title)
            if number:
                ax.annotate("", (0.0, 0.5), (-0.12, 0.5), xycoords="axes fraction", arrowprops=_ARROW)
        _network(axes[0, 1], lab.width, w.shape[1], own)


_ARROW: dict[str, Any] = {"arrowstyle": "-|>", "color": "#444444", "linewidth": 1.6}


def _network(ax: Any, width: int, outputs: int, own: Array) -> None:
    """The layers with their sizes, and the weights at the control points that it has learned."""
    ax.set_title("network")
    ax.set(xlim=(0, 1), ylim=(0, 1))
    ax.annotate("", (0.02, 0.5), (-0.12, 0.5), xycoords="axes fraction", arrowprops=_ARROW)
    for place, (size, height) in zip(
        np.linspace(0.12, 0.88, 4), ((3, 0.1), (width, 0.5), (width, 0.5), (outputs, 0.2)), strict=True
    ):
        ax.bar(place, height, 0.13, bottom=0.66 - height / 2, color=NEURAL, alpha=0.75)
        ax.text(place, 0.66 + height / 2 + 0.02, str(size), ha="center", va="bottom")
    bars = np.linspace(0.08, 0.92, outputs)
    ax.bar(bars, 0.22 * own, 0.6 / outputs, bottom=0.08, color=[COLOURS[i % len(COLOURS)] for i in range(outputs)])
    ax.text(0.5, 0.07, f"at its own place {own.min():.2f} to {own.max():.2f}", ha="center", va="top", fontsize=9)


def _picture(lab: Lab, subject: Subject, panel: Panel, points: ControlPoints) -> Array:
    from matplotlib.image import imread

    azimuth, elevation = subject.view
    with TemporaryDirectory() as folder:
        path = Path(folder) / "panel.png"
        render(
            [panel], path, control_points=points, width=120 if lab.quick else 420, azimuth=azimuth, elevation=elevation
        )
        found: Array = imread(path)
    return found


def _rgb(colour: str) -> tuple[float, float, float]:
    from matplotlib.colors import to_rgb

    return to_rgb(colour)
