"""One parameter of the classic weights through its range, on the paper's plain chair, with neural weights beside."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from neuralmls import InverseDistanceWeights, NeuralWeights
from neuralmls_research.experiments.reproduce.drawing import draw_shapes
from neuralmls_research.experiments.reproduce.lab import Lab
from neuralmls_research.experiments.reproduce.outcomes import (
    NEURAL_LABEL,
    SEED,
    STEPS,
    Outcome,
    Setting,
    by_settings,
    draw_curves,
    first_of,
    table,
)
from neuralmls_research.experiments.reproduce.outcomes import numbers as numbers_of
from neuralmls_research.experiments.reproduce.report import Picture, Report
from neuralmls_research.experiments.reproduce.subjects import plain_chair

SHOWN = ("error", "error_at_points", "curvature_median", "dirichlet")


@dataclass(frozen=True)
class Sweep:
    """The classic outcomes by the parameter's value, the neural ones by seed, and the report so far, without claims."""

    classic: Mapping[float, Outcome]
    neural: Sequence[Outcome]
    report: Report

    def seeds(self, measure: str) -> list[float]:
        """A measure of the neural outcomes, a value a seed."""
        return [outcome.numbers[measure] for outcome in self.neural]


def classic_sweep(
    lab: Lab, item: str, parameter: str, values: Mapping[float, dict[str, float]], columns: int, caption: str
) -> Sweep:
    """Deform the chair with each of the options of the classic weights, and with neural ones."""
    subject = plain_chair(lab)
    p, bounds = subject.points.sources, subject.bounds
    settings = [
        Setting(f"{parameter} = {value:g}", InverseDistanceWeights(p, bounds=bounds, **options))
        for value, options in values.items()
    ]
    for seed in lab.seeds:
        weights = NeuralWeights.fit(p, bounds=bounds, width=lab.width, steps=STEPS, seed=seed)
        settings.append(Setting(f"{NEURAL_LABEL}{SEED}{seed}", weights))
    found = by_settings(subject, settings)
    classic, neural = found[: len(values)], found[len(values) :]
    draw_shapes(lab, f"{item}-{parameter}.png", subject, first_of(found), columns)
    draw_curves(lab, f"{item}-curves.png", parameter, list(values), classic, SHOWN, neural[0])
    report = Report(
        f"{subject.label}; classic weights 1/(d^(2 alpha) + epsilon), distances in halves of the longest side; network "
        f"of width {lab.width}, {STEPS} steps, temperature 1, {len(lab.seeds)} seeds, of which the first is drawn.",
        pictures=[
            Picture(f"{item}-{parameter}.png", caption),
            Picture(f"{item}-curves.png", "Measures of the same shapes; the broken line is the neural one."),
        ],
        tables=[table(f"{item}-{parameter}", f"Over {parameter}.", parameter, found, SHOWN)],
        numbers=numbers_of(found),
        missing=subject.missing,
    )
    return Sweep(dict(zip(values, classic, strict=True)), neural, report)
