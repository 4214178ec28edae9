"""Figure 10: classic weights whose peak is capped by epsilon, from 1e-8 to 1e-2."""

from __future__ import annotations

from neuralmls_research.experiments.reproduce import verdicts
from neuralmls_research.experiments.reproduce.classic_sweep import classic_sweep
from neuralmls_research.experiments.reproduce.lab import Lab
from neuralmls_research.experiments.reproduce.report import Claim, Conclusions, Report
from neuralmls_research.experiments.reproduce.words import span

EPSILONS = (1e-8, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2)
CAPTION = (
    "Epsilon caps the weight at a control point. The flat back and seat bend with every value; a large one only leaves "
    "the targets (blue) behind as well. Last, neural weights."
)


def run(lab: Lab) -> Report:
    """Deform the chair with each epsilon."""
    options = {value: {"epsilon": value} for value in EPSILONS[:: 3 if lab.quick else 1]}
    sweep = classic_sweep(lab, "fig10", "epsilon", options, 5, CAPTION)
    errors = [outcome.numbers["error_at_points"] for outcome in sweep.classic.values()]
    least = min(outcome.numbers["curvature_median"] for outcome in sweep.classic.values())
    neural = sweep.seeds("curvature_median")
    behind = verdicts.times_more(100, errors[0], errors[-1])
    bent = verdicts.less("the neural change", neural, least, "the classic one with the best epsilon", factor=2)
    sweep.report.claims += [
        Claim(
            paper="Figure 10: a larger epsilon leaves the control points behind.",
            measure="A picture in the paper; here the mean distance of control points from their targets.",
            measured=f"{errors[0]:.1g} with epsilon {EPSILONS[0]:g}, {errors[-1]:.4f} with {EPSILONS[-1]:g}.",
            ruling=behind,
            conclusions=Conclusions(
                "A larger epsilon costs closeness.",
                "A larger epsilon costs a little closeness.",
                "Epsilon costs no closeness.",
            ),
        ),
        Claim(
            paper="Figure 10: no epsilon takes the distortion of classic weights away.",
            measure="A picture in the paper; here the median change of mean curvature.",
            measured=f"{least:.3g} with the best epsilon, neural {span(neural)}.",
            ruling=bent,
            conclusions=Conclusions(
                "Epsilon is no remedy for the bending of flat parts.",
                "With the best epsilon classic weights bend more, by less than twice.",
                "With a good epsilon classic weights bend no more than neural ones.",
            ),
        ),
    ]
    return sweep.report
