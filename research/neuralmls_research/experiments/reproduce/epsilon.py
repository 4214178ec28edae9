"""Figure 10: classic weights whose peak is capped by epsilon, from 1e-8 to 1e-2."""

from __future__ import annotations

from neuralmls_research.experiments.reproduce import verdicts
from neuralmls_research.experiments.reproduce.classic_sweep import classic_sweep
from neuralmls_research.experiments.reproduce.lab import Lab
from neuralmls_research.experiments.reproduce.report import Claim, Report

EPSILONS = (1e-8, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2)
CAPTION = (
    "Epsilon caps the weight at a control point. The flat back and seat bend with every value; a large one only leaves "
    "the targets (blue) behind as well. Last, neural weights."
)


def run(lab: Lab) -> Report:
    """Deform the chair with each epsilon."""
    options = {value: {"epsilon": value} for value in EPSILONS[:: 3 if lab.quick else 1]}
    sweep = classic_sweep(lab, "fig10", "epsilon", options, 5, CAPTION)
    neural, numbers = sweep.neural.numbers, [o.numbers for o in sweep.classic.values()]
    least = min(row["curvature_median"] for row in numbers)
    behind = verdicts.times_more(100, numbers[0]["error_at_points"], numbers[-1]["error_at_points"])
    distorted = verdicts.less("the neural value", [neural["curvature_median"]], factor=2, rival=least)
    sweep.report.claims += [
        Claim(
            paper="A larger epsilon leaves the control points behind.",
            measure="Control-point error.",
            rule=behind.rule,
            measured=f"Mean distance of control points from their targets: {numbers[0]['error_at_points']:.1g} "
            f"with epsilon "
            f"1e-8, {numbers[-1]['error_at_points']:.4f} with 1e-2.",
            verdict=behind.verdict,
            reader="Epsilon costs closeness.",
        ),
        Claim(
            paper="No epsilon takes the distortion of classic weights away.",
            measure="Median change of mean curvature.",
            rule=distorted.rule,
            measured=f"Median change of mean curvature: {least:.3g} with the best epsilon, "
            f"{neural['curvature_median']:.3g} "
            "with neural weights.",
            verdict=distorted.verdict,
            reader="Epsilon is no answer to the distortion.",
        ),
    ]
    return sweep.report
