"""One parameter of the classic weights through its range, on the paper's plain chair, with neural weights beside."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from neuralmls import InverseDistanceWeights, NeuralWeights
from neuralmls_research.experiments.reproduce.drawing import draw_shapes
from neuralmls_research.experiments.reproduce.lab import Lab
from neuralmls_research.experiments.reproduce.outcomes import Outcome, Setting, by_settings, draw_curves, table
from neuralmls_research.experiments.reproduce.outcomes import numbers as numbers_of
from neuralmls_research.experiments.reproduce.report import Picture, Report
from neuralmls_research.experiments.reproduce.subjects import plain_chair

SHOWN = ("error", "error_at_points", "curvature_median", "dirichlet")


@dataclass(frozen=True)
class Sweep:
    """The classic outcomes by the parameter's value, the neural one, and the report so far, without claims."""

    classic: Mapping[float, Outcome]
    neural: Outcome
    report: Report


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
    settings.append(Setting("neural", NeuralWeights.fit(p, bounds=bounds, width=lab.width, steps=48)))
    found = by_settings(subject, settings)
    *classic, neural = found
    draw_shapes(lab, f"{item}-{parameter}.png", subject, {o.label: o.positions for o in found}, columns)
    draw_curves(lab, f"{item}-curves.png", parameter, list(values), classic, SHOWN, neural)
    report = Report(
        f"{subject.label}; classic weights 1/(d^(2 alpha) + epsilon), distances in halves of the longest side; network "
        f"of width {lab.width}, 48 steps, temperature 1.",
        pictures=[
            Picture(f"{item}-{parameter}.png", caption),
            Picture(f"{item}-curves.png", "Measures of the same shapes; the broken line is the neural one."),
        ],
        tables=[table(f"{item}-{parameter}", f"Over {parameter}.", parameter, found, SHOWN)],
        numbers=numbers_of(found),
        missing=subject.missing,
    )
    return Sweep(dict(zip(values, classic, strict=True)), neural, report)
