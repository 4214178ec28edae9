"""Figure 2: weights of six control points on a line, before and after one of them moves."""

from __future__ import annotations

import numpy as np

from neuralmls_research.experiments.reproduce import verdicts
from neuralmls_research.experiments.reproduce.drawing import draw_weights, plots
from neuralmls_research.experiments.reproduce.lab import Lab
from neuralmls_research.experiments.reproduce.line import AFTER, BEFORE, SETTING, X, functions, peaks, weights_on_line
from neuralmls_research.experiments.reproduce.report import Claim, Picture, Report


def run(lab: Lab) -> Report:
    """Draw the figure; count the peaks of each weight, and see how far the move is felt."""
    before, after = (
        {kind: weights_on_line(function) for kind, function in functions(lab, p).items()} for p in (BEFORE, AFTER)
    )
    with plots(lab, "fig2-weights.png", 2, 2, (11, 5.4), sharex=True, sharey=True) as axes:
        for row, kind in zip(axes, before, strict=True):
            draw_weights(row[0], X, before[kind], BEFORE, f"{kind}, as placed")
            draw_weights(row[1], X, after[kind], AFTER, f"{kind}, the fourth moved by -1")
            row[0].set_ylabel("weight")
        for ax in axes[-1]:
            ax.set_xlabel("x")

    far = X[:, 0] < BEFORE[1, 0]
    most = {kind: max(map(peaks, np.hstack([before[kind], after[kind]]).T)) for kind in before}
    plateau = {kind: float(np.mean([(w[kind].max(axis=1) > 0.9).mean() for w in (before, after)])) for kind in before}
    change = {kind: float(np.abs(after[kind] - before[kind])[far].max()) for kind in before}
    smooth = verdicts.together(
        verdicts.below(2, [most["neural"]]),
        verdicts.more("the share above 0.9", [plateau["neural"]], plateau["classic"]),
    )
    fits = verdicts.less("the change of neural weights", [change["neural"]], change["classic"])
    return Report(
        SETTING.format(width=lab.width),
        pictures=[
            Picture(
                "fig2-weights.png",
                "A curve for each control point, which the dot below of the same colour marks. Neural weights (above) "
                "are plateaus with soft borders, one to a control point; classic ones (below) are 1 at a single place "
                "and come up again behind other control points. When the fourth moves (right), the plateaus beside "
                "it shrink and grow to fit.",
            )
        ],
        claims=[
            Claim(
                paper="Neural weights are piecewise smooth: each control point rules one piece, with a smooth border.",
                measure="Peaks of a weight; share of the line where one control point has over 0.9.",
                rule=smooth.rule,
                measured=f"A neural weight has at most {most['neural']} peak, a classic one up to "
                f"{most['classic']}; one "
                f"control point has over 0.9 of the weight on {plateau['neural']:.0%} of the line, with classic "
                f"weights on {plateau['classic']:.0%}.",
                verdict=smooth.verdict,
                reader="Each control point rules one piece of the line.",
            ),
            Claim(
                paper="Neural weights fit themselves to where the control points are: a move changes its surroundings.",
                measure="The largest change of a weight far from the control point that moves.",
                rule=fits.rule,
                measured=f"Left of the second control point the move of the fourth changes neural weights by at most "
                f"{change['neural']:.3f}, classic ones by {change['classic']:.3f}.",
                verdict=fits.verdict,
                reader="A move is felt nearby.",
            ),
        ],
        numbers={"most_peaks": most, "share_above_0.9": plateau, "far_change": change},
    )
