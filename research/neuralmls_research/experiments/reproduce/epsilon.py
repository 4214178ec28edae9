"""Figure 10: classic weights whose peak is capped by epsilon, from 1e-8 to 1e-2."""

from __future__ import annotations

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
    sweep.report.claims += [
        Claim(
            "A larger epsilon leaves the control points behind.",
            f"Mean distance of control points from their targets: {numbers[0]['error_at_points']:.1g} with epsilon "
            f"1e-8, {numbers[-1]['error_at_points']:.4f} with 1e-2.",
            numbers[-1]["error_at_points"] > 100 * numbers[0]["error_at_points"],
        ),
        Claim(
            "No epsilon takes the distortion of classic weights away.",
            f"Median change of mean curvature: {least:.3g} with the best epsilon, {neural['curvature_median']:.3g} "
            "with neural weights.",
            least > 2 * neural["curvature_median"],
        ),
    ]
    return sweep.report
