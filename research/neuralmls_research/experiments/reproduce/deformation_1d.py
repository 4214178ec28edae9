"""Figure 7: what neural and classic weights make of the same displacements of six control points on a line."""

from __future__ import annotations

import numpy as np

from neuralmls import Deformer
from neuralmls_research.experiments.reproduce import verdicts
from neuralmls_research.experiments.reproduce.drawing import CLASSIC, NEURAL, draw_weights, plots
from neuralmls_research.experiments.reproduce.lab import Lab
from neuralmls_research.experiments.reproduce.line import BEFORE, SETTING, X, functions, weights_on_line
from neuralmls_research.experiments.reproduce.report import Claim, Picture, Report

# As in the published script: displacements from -5 to 5, two of them none.
OFFSETS = np.array([[-5.0], [-2.5], [0.0], [0.0], [2.5], [5.0]])


def run(lab: Lab) -> Report:
    """Draw both deformations with their weights, and measure how much they go up and down."""
    made = functions(lab, BEFORE)
    moved, missed = {}, {}
    for kind, function in made.items():
        moved[kind] = np.asarray(Deformer(X, function).deform(BEFORE + OFFSETS)) - X
        missed[kind] = Deformer(BEFORE, function).deform(BEFORE + OFFSETS) - (BEFORE + OFFSETS)
    with plots(lab, "fig7-deformation.png", 2, 2, (11, 5.4), sharex=True, sharey="row") as axes:
        for column, (kind, colour) in enumerate((("neural", NEURAL), ("classic", CLASSIC))):
            ax = axes[0, column]
            ax.plot(X[:, 0], moved[kind][:, 0], color=colour)
            ax.plot(BEFORE[:, 0], OFFSETS[:, 0], "o", color="#222222", markersize=5)
            ax.set_title(f"{kind}: displacement")
            draw_weights(axes[1, column], X, weights_on_line(made[kind]), BEFORE, f"{kind}: weights")
            axes[1, column].set_xlabel("x")
        axes[0, 0].set_ylabel("displacement")
        axes[1, 0].set_ylabel("weight")

    # The displacements of the control points only rise: what a curve goes down by, it made up.
    down = {kind: float(-np.minimum(np.diff(curve[:, 0]), 0).sum()) for kind, curve in moved.items()}
    error = {kind: float(np.abs(miss).max()) for kind, miss in missed.items()}
    smooth = verdicts.less("the neural value", [down["neural"]], factor=10, rival=down["classic"])
    close = verdicts.below(0.05, [error["neural"]])
    return Report(
        SETTING.format(width=lab.width),
        pictures=[
            Picture(
                "fig7-deformation.png",
                "Above, how far each place of the line moves; dots are the displacements asked for. Neural weights "
                "give steps: pieces that move as one, with soft transitions. Classic ones go through the dots too, "
                "but turn back between and behind them. Below, the weights that make the curves.",
            )
        ],
        claims=[
            Claim(
                paper="Neural weights give a piecewise smooth deformation, classic ones one that wavers.",
                measure="How far the displacement goes down between targets that only rise.",
                rule=smooth.rule,
                measured=f"The displacements asked for only rise; the neural curve goes down by "
                f"{down['neural']:.2f} in all, "
                f"the classic one by {down['classic']:.2f} (of 10 that they rise by).",
                verdict=smooth.verdict,
                reader="Neural weights give steps, classic ones turn back.",
            ),
            Claim(
                paper="The control points are approximated closely, though nothing forces an interpolation.",
                measure="The worst distance from a displacement asked for.",
                rule=close.rule,
                measured=f"Worst distance from a displacement asked for: neural {error['neural']:.4f}, "
                f"classic {error['classic']:.4f} (of 10).",
                verdict=close.verdict,
                reader="Control points nearly arrive.",
            ),
        ],
        numbers={"goes_down_by": down, "worst_control_point_error": error},
    )
