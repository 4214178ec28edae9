"""What the network's width, the steps of its training and its seed change."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from neuralmls import InverseDistanceWeights, NeuralWeights, softmax
from neuralmls_research.experiments.reproduce import verdicts
from neuralmls_research.experiments.reproduce.drawing import NEURAL, plots
from neuralmls_research.experiments.reproduce.lab import Lab
from neuralmls_research.experiments.reproduce.outcomes import (
    CLASSIC_LABEL,
    Outcome,
    Setting,
    by_settings,
    numbers,
    table,
)
from neuralmls_research.experiments.reproduce.outcomes import STEPS as PUBLISHED_STEPS
from neuralmls_research.experiments.reproduce.report import Claim, Conclusions, Picture, Report
from neuralmls_research.experiments.reproduce.subjects import chair
from neuralmls_research.experiments.reproduce.words import span

WIDTHS = (64, 128, 256, 512, 1024)
STEPS = (12, 24, 48, 96, 200)
SEEDS = (0, 1, 2, 3, 4)
SHOWN = ("error_at_points", "error", "curvature_median", "dirichlet")


def run(lab: Lab) -> Report:
    """Train networks that differ in one thing at a time, and deform the chair by each."""
    subject = chair(lab)
    p = subject.points.sources
    widths = tuple(width for width in WIDTHS if width <= lab.width)

    def fit(width: int, steps: int, seed: int) -> NeuralWeights:
        return NeuralWeights.fit(p, bounds=subject.bounds, width=width, steps=steps, seed=seed)

    series: dict[str, Mapping[float, NeuralWeights]] = {
        "width": {width: fit(width, PUBLISHED_STEPS, 0) for width in widths},
        "steps": {steps: fit(lab.width, steps, 0) for steps in STEPS},
        "seed": {seed: fit(lab.width, PUBLISHED_STEPS, seed) for seed in SEEDS},
    }
    own = {name: [_own_weight(weights) for weights in fits.values()] for name, fits in series.items()}
    found = {
        name: by_settings(subject, [Setting(f"{name} {value}", weights) for value, weights in fits.items()])
        for name, fits in series.items()
    }
    _draw(lab, series, own, found)
    errors, distortion = (
        np.array([o.numbers[key] for o in found["seed"]]) for key in ("error_at_points", "curvature_median")
    )
    classic = by_settings(subject, [Setting(CLASSIC_LABEL, InverseDistanceWeights(p, alpha=0.5))])[0]
    rival = classic.numbers["curvature_median"]
    steady = verdicts.together(
        verdicts.below(0.01, [float(np.ptp(errors))]),
        verdicts.less(
            "the spread of the seeds' distortions",
            [float(np.ptp(distortion))],
            float(np.abs(distortion - rival).min()),
            "the nearest seed's distance from the classic distortion",
        ),
    )
    report = Report(
        f"{subject.label}; width {lab.width}, {PUBLISHED_STEPS} steps and seed 0 where nothing else is "
        "said; temperature 1, rigid. The paper gives neither steps nor rate: they are the published code's.",
        pictures=[
            Picture(
                "training.png",
                "Above, the weight that a control point has at its own place (mean); below, how far control points end "
                "from their targets. A narrow network or few steps leave them behind; seeds differ little.",
            )
        ],
        tables=[
            table(
                "training",
                "All measures.",
                "network",
                [*(o for group in found.values() for o in group), classic],
                SHOWN,
            )
        ],
        missing=subject.missing,
        numbers={name: {"own_weight": own[name], "measures": numbers(found[name])} for name in series},
        claims=[
            Claim(
                paper="Seeds differ less than methods do.",
                measure="Control-point error and median change of mean curvature.",
                measured=f"Five seeds: control-point error {span(errors.tolist(), '{:.4f}')}, median change of mean "
                f"curvature {span(distortion.tolist())}; {CLASSIC_LABEL} {rival:.3g}.",
                ruling=steady,
                conclusions=Conclusions(
                    "On this chair the difference between the methods is larger than that between seeds.",
                    "Seeds differ about as much as methods do in one of the measures: run several.",
                    "Seeds differ as much as methods do: one seed says nothing.",
                ),
                ours=True,
            )
        ],
    )
    if 128 in series["width"]:
        narrow, wide = series["width"][128], series["width"][1024]
        missed = {width: o.numbers["error_at_points"] for width, o in zip(widths, found["width"], strict=True)}
        enough = verdicts.together(
            verdicts.above(0.9, [_own_weight(wide)]),
            verdicts.below(0.9, [_own_weight(narrow)]),
        )
        report.claims.append(
            Claim(
                paper="With the paper's width the published code's 48 steps are enough, with the code's own not.",
                measure="The weight that a control point has at its own place.",
                measured=f"Own weight {_own_weight(wide):.2f} and {_own_weight(narrow):.2f}; control-point error "
                f"{missed[1024]:.3f} and {missed[128]:.3f}.",
                ruling=enough,
                conclusions=Conclusions(
                    "Take the paper's width, or train longer: a control point must own its place.",
                    "Width is not all that counts here.",
                    "The width does not decide it here.",
                ),
                ours=True,
            )
        )
    return report


def _own_weight(weights: NeuralWeights) -> float:
    """The mean weight of control points at their own places."""
    return float(np.diagonal(softmax(weights.logits(weights.control_points))).mean())


def _draw(
    lab: Lab,
    series: Mapping[str, Mapping[float, NeuralWeights]],
    own: Mapping[str, list[float]],
    found: Mapping[str, list[Outcome]],
) -> None:
    with plots(lab, "training.png", 2, 3, (11, 5.2), sharex="col", sharey="row") as axes:
        for column, (name, fits) in enumerate(series.items()):
            values = list(fits)
            line = "o" if name == "seed" else "o-"
            missed = [outcome.numbers["error_at_points"] for outcome in found[name]]
            for ax, measured in zip(axes[:, column], (own[name], missed), strict=True):
                ax.plot(values, measured, line, color=NEURAL)
                if name == "seed":
                    ax.axhspan(min(measured), max(measured), color=NEURAL, alpha=0.15, linewidth=0)
                    ax.set_xticks(values)
                else:
                    ax.set_xscale("log", base=2)
                    ax.set_xticks(values, [f"{value:g}" for value in values])
            axes[1, column].set_xlabel(name)
        axes[0, 0].set(ylabel="own weight", ylim=(0, 1.05))
        axes[1, 0].set(ylabel="control-point error", ylim=(0, None))
