"""Fourier features and affine maps, which the published code uses for the airplanes of its study."""

from __future__ import annotations

from neuralmls import NeuralWeights
from neuralmls_research.experiments.reproduce import verdicts
from neuralmls_research.experiments.reproduce.drawing import draw_shapes
from neuralmls_research.experiments.reproduce.lab import Lab
from neuralmls_research.experiments.reproduce.outcomes import Setting, by_settings, numbers, table
from neuralmls_research.experiments.reproduce.report import Claim, Picture, Report
from neuralmls_research.experiments.reproduce.subjects import airplane

SIGMA = 2.0  # of the published study
STEPS = 72
SHOWN = ("error_at_points", "curvature", "curvature_median", "dirichlet", "flipped")


def run(lab: Lab) -> Report:
    """Deform the airplane with and without either."""
    subject = airplane(lab)
    p, bounds = subject.points.sources, subject.bounds
    plain, fourier = (
        NeuralWeights.fit(p, bounds=bounds, width=lab.width, steps=STEPS, fourier_sigma=sigma)
        for sigma in (None, SIGMA)
    )
    found = by_settings(
        subject,
        [
            Setting("rigid", plain),
            Setting("affine", plain, transform="affine"),
            Setting("Fourier, rigid", fourier),
            Setting("Fourier, affine", fourier, transform="affine"),
        ],
    )
    draw_shapes(lab, "fourier.png", subject, {o.label: o.positions for o in found}, 5)
    named = numbers(found)
    rigid, published = named["rigid"], named["Fourier, affine"]
    better = verdicts.together(
        *(verdicts.order({"published": [published[key]], "rigid": [rigid[key]]}) for key in SHOWN[:3:2])
    )
    return Report(
        f"{subject.label}; width {lab.width}, {STEPS} steps as in the published study, Fourier features with sigma "
        f"{SIGMA:g}, temperature 1.",
        pictures=[
            Picture(
                "fourier.png",
                "Affine maps let the wings stretch with their control points; Fourier features let the weights change "
                "within a shorter distance. The published code uses both together for airplanes.",
            )
        ],
        tables=[table("fourier", "Measures.", "network and maps", found, SHOWN)],
        claims=[
            Claim(
                paper="For airplanes, Fourier features with affine maps do better (the published study's setting).",
                measure="Control-point error and median change of mean curvature.",
                rule=better.rule,
                measured=f"Control-point error {published['error_at_points']:.3f} against "
                f"{rigid['error_at_points']:.3f} of the "
                f"plain rigid setting; median change of mean curvature {published['curvature_median']:.3g} against "
                f"{rigid['curvature_median']:.3g}; Dirichlet energy {published['dirichlet']:.3g} against "
                f"{rigid['dirichlet']:.3g}.",
                verdict=better.verdict,
                reader="They are closer, and distort more.",
                ours=True,
            )
        ],
        numbers=named,
        missing=subject.missing,
    )
