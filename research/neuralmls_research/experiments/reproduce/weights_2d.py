"""Weights of a square of four control points, before and after one of them moves inside."""

from __future__ import annotations

import numpy as np

from neuralmls import InverseDistanceWeights, NeuralWeights, Weights, softmax
from neuralmls_research.experiments.reproduce import verdicts
from neuralmls_research.experiments.reproduce.drawing import plots
from neuralmls_research.experiments.reproduce.lab import Lab
from neuralmls_research.experiments.reproduce.report import Claim, Picture, Report

HALF = 0.3
BEFORE = np.array([[-HALF, -HALF], [HALF, -HALF], [-HALF, HALF], [HALF, HALF]])
AFTER = np.array([*BEFORE[:3], [0.1, 0.15]])
CORNERS = ("lower left", "lower right", "upper left", "upper right")


def run(lab: Lab) -> Report:
    """Draw the weights, and measure how much of the square each control point rules."""
    side = 41 if lab.quick else 201
    axis = np.linspace(-HALF, HALF, side)
    grid = np.stack(np.meshgrid(axis, axis), axis=-1).reshape(-1, 2)
    bounds = [[-HALF, -HALF], [HALF, HALF]]
    made: dict[str, Weights] = {}
    for when, p in (("before", BEFORE), ("after", AFTER)):
        made[f"neural, {when}"] = NeuralWeights.fit(p, bounds=bounds, width=lab.width, steps=72)
        made[f"classic, {when}"] = InverseDistanceWeights(p, bounds=bounds)
    weights = {name: softmax(function.logits(grid)) for name, function in sorted(made.items(), reverse=True)}
    with plots(lab, "square-weights.png", 4, 4, (9.6, 8.9), sharex=True, sharey=True) as axes:
        for row, (name, w) in zip(axes, weights.items(), strict=True):
            for i, ax in enumerate(row):
                image = ax.imshow(
                    w[:, i].reshape(side, side),
                    origin="lower",
                    extent=(-HALF, HALF, -HALF, HALF),
                    vmin=0,
                    vmax=1,
                    cmap="viridis",
                )
                p = made[name].control_points
                ax.plot(*p.T, "o", color="white", markeredgecolor="black", markersize=5, clip_on=False)
                ax.plot(*p[i], "o", color="#d55e00", markeredgecolor="white", markersize=8, clip_on=False, zorder=5)
                ax.set(xticks=[], yticks=[])
                ax.grid(False)
                ax.spines[:].set_visible(False)
            row[0].set_ylabel(name)
        for ax, corner in zip(axes[0], CORNERS, strict=True):
            ax.set_title(corner)
        ax.figure.colorbar(image, ax=axes, shrink=0.4, label="weight")

    rules = {name: np.bincount(w.argmax(axis=1), minlength=4) / len(w) for name, w in weights.items()}
    ruled = {name: share.round(4).tolist() for name, share in rules.items()}
    own = {name: float((w.max(axis=1) > 0.9).mean()) for name, w in weights.items()}
    grown = rules["neural, after"][3] - rules["neural, before"][3]
    changed = verdicts.together(
        verdicts.above(0.01, [abs(grown)]),
        verdicts.more("the share above 0.9", [own["neural, after"]], own["classic, after"]),
    )
    return Report(
        f"Grid of {side} x {side} points on the square [-0.3, 0.3]² of the published script; network of width "
        f"{lab.width}, 72 steps, temperature 1; classic weights 1/d². The upper right control point moves to "
        "(0.1, 0.15).",
        pictures=[
            Picture(
                "square-weights.png",
                "A column for each control point (orange), a row for each configuration: its weight from 0 (dark) "
                "to 1 (bright). The upper right one moves inwards: neural regions re-form as a whole, each "
                "connected; classic weights are bright at their control point alone.",
            )
        ],
        claims=[
            Claim(
                paper="In 2D too, moving one control point changes the weights of all to fit the new configuration.",
                measure="Share of the square that the moved control point rules.",
                rule=changed.rule,
                measured=f"Share of the square ruled by the moved control point: {rules['neural, before'][3]:.3f} "
                f"before, "
                f"{rules['neural, after'][3]:.3f} after. One control point has over 0.9 of the weight on "
                f"{own['neural, before']:.0%} and {own['neural, after']:.0%} of the square, with classic weights on "
                f"{own['classic, before']:.0%} and {own['classic, after']:.0%}.",
                verdict=changed.verdict,
                reader="Regions re-form as a whole.",
            )
        ],
        numbers={"share_ruled": ruled, "share_above_0.9": own},
    )
