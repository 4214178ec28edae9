"""Fourier features and affine maps, which the published code uses for the airplanes of its study."""

from __future__ import annotations

from collections.abc import Sequence

from neuralmls import NeuralWeights
from neuralmls.plugin import Transform
from neuralmls_research.experiments.reproduce import verdicts
from neuralmls_research.experiments.reproduce.drawing import draw_shapes
from neuralmls_research.experiments.reproduce.lab import Lab
from neuralmls_research.experiments.reproduce.outcomes import (
    SEED,
    Outcome,
    Setting,
    by_settings,
    first_of,
    numbers,
    seeds_of,
    table,
)
from neuralmls_research.experiments.reproduce.report import Claim, Conclusions, Picture, Report
from neuralmls_research.experiments.reproduce.subjects import airplane
from neuralmls_research.experiments.reproduce.words import span

PLAIN, PUBLISHED = "rigid", "Fourier, affine"
SIGMA = 2.0  # of the published study
STEPS = 72
SHOWN = ("error_at_points", "curvature", "curvature_median", "dirichlet", "flipped")


def run(lab: Lab) -> Report:
    """Deform the airplane with and without either, with each seed."""
    subject = airplane(lab)
    p, bounds = subject.points.sources, subject.bounds
    kinds: tuple[tuple[str, float | None, Transform], ...] = (
        (PLAIN, None, "rigid"),
        ("affine", None, "affine"),
        ("Fourier, rigid", SIGMA, "rigid"),
        (PUBLISHED, SIGMA, "affine"),
    )
    settings = []
    for label, sigma, transform in kinds:
        # What the claim compares runs with every seed, the rest, which is for the picture, with the first.
        for seed in lab.seeds if label in (PLAIN, PUBLISHED) else lab.seeds[:1]:
            weights = NeuralWeights.fit(p, bounds=bounds, width=lab.width, steps=STEPS, fourier_sigma=sigma, seed=seed)
            settings.append(Setting(f"{label}{SEED}{seed}", weights, transform=transform))
    found = by_settings(subject, settings)
    draw_shapes(lab, "fourier.png", subject, first_of(found), 5)
    return Report(
        f"{subject.label}; width {lab.width}, {STEPS} steps as in the published study, Fourier features with sigma "
        f"{SIGMA:g}, temperature 1; {len(lab.seeds)} seeds of the first and the last, of which the first is drawn.",
        pictures=[
            Picture(
                "fourier.png",
                "Affine maps let the wings stretch with their control points; Fourier features let the weights change "
                "within a shorter distance. The published code uses both together for airplanes.",
            )
        ],
        tables=[table("fourier", "Measures; least and largest of the seeds.", "network and maps", found, SHOWN)],
        claims=[_claim(found)],
        numbers=numbers(found),
        missing=subject.missing,
    )


def _claim(found: Sequence[Outcome]) -> Claim:
    values = {measure: seeds_of(found, measure) for measure in SHOWN}
    ruling = verdicts.together(
        *(
            verdicts.order({name: values[measure][name] for name in (PUBLISHED, PLAIN)})
            for measure in ("error_at_points", "curvature_median")
        )
    )

    def said(measure: str) -> str:
        return f"{span(values[measure][PUBLISHED])} ({PLAIN} {span(values[measure][PLAIN])})"

    return Claim(
        paper="For airplanes, Fourier features with affine maps do better: the setting of the published study.",
        measure="Control-point error and median change of mean curvature.",
        measured=f"Control-point error {said('error_at_points')}, median change of mean curvature "
        f"{said('curvature_median')}, Dirichlet energy {said('dirichlet')}.",
        ruling=ruling,
        conclusions=Conclusions(
            "The study's setting is closer, and distorts less.",
            "The study's setting is closer to the targets, and distorts far more.",
            "The study's setting is neither closer nor less distorted.",
        ),
        ours=True,
    )
