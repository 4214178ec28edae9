"""Figure 8: neural weights at temperatures from 0.2 to 5."""

from __future__ import annotations

from neuralmls import NeuralWeights
from neuralmls_research.experiments.reproduce import verdicts
from neuralmls_research.experiments.reproduce.drawing import draw_shapes
from neuralmls_research.experiments.reproduce.lab import Lab
from neuralmls_research.experiments.reproduce.outcomes import Setting, by_settings, draw_curves, numbers, table
from neuralmls_research.experiments.reproduce.report import Claim, Picture, Report
from neuralmls_research.experiments.reproduce.subjects import plain_chair

TEMPERATURES = (0.2, 0.3, 0.5, 0.8, 1.0, 2.0, 3.0, 4.0, 5.0)
SHOWN = ("error_at_points", "curvature_median", "dirichlet")


def run(lab: Lab) -> Report:
    """Deform the chair at each temperature with one network, trained once."""
    subject, values = plain_chair(lab), TEMPERATURES[:: 4 if lab.quick else 1]
    weights = NeuralWeights.fit(subject.points.sources, bounds=subject.bounds, width=lab.width, steps=48)
    found = by_settings(subject, [Setting(f"T = {value:g}", weights, value) for value in values])
    draw_shapes(lab, "fig8-temperature.png", subject, {o.label: o.positions for o in found}, 5)
    draw_curves(lab, "fig8-curves.png", "temperature", values, found, SHOWN)
    error, energy = ([o.numbers[name] for o in found] for name in ("error_at_points", "dirichlet"))
    trade = verdicts.together(verdicts.rises(error), verdicts.falls(energy))
    return Report(
        f"{subject.label}; one network of width {lab.width}, 48 steps, evaluated at each temperature.",
        pictures=[
            Picture(
                "fig8-temperature.png",
                "Low temperatures reach the targets (blue) with parts that move as one and stretch little beside "
                "their borders; high ones spread the motion evenly and leave the targets behind.",
            ),
            Picture(
                "fig8-curves.png",
                "The same as curves. With the temperature control points are missed by more, flat sides bend more, and "
                "the stretch spreads out, so that its energy falls.",
            ),
        ],
        tables=[table("fig8-temperature", "Over the temperature.", "temperature", found, SHOWN)],
        claims=[
            Claim(
                paper="The temperature trades interpolation (low) for smooth approximation (high).",
                measure="Control-point error, and symmetric Dirichlet energy, over the temperature.",
                rule=trade.rule,
                measured=f"From T = 0.2 to 5 the control-point error rises from {error[0]:.1g} to {error[-1]:.3f}, "
                f"and the "
                f"symmetric Dirichlet energy falls from {energy[0]:.2f} to {energy[-1]:.2f} (4 is none).",
                verdict=trade.verdict,
                reader="The temperature chooses between the two.",
            )
        ],
        numbers=numbers(found),
        missing=subject.missing,
    )
