"""Figure 9: classic weights with exponents from 0.05 to 5."""

from __future__ import annotations

from neuralmls_research.experiments.reproduce.classic_sweep import SHOWN, classic_sweep
from neuralmls_research.experiments.reproduce.lab import Lab
from neuralmls_research.experiments.reproduce.report import Claim, Report

ALPHAS = (0.05, 0.1, 0.2, 0.3, 0.5, 0.8, 1.0, 2.0, 3.0, 4.0, 5.0)
CAPTION = (
    "With a small alpha the surface stays behind and is pulled to the targets (blue) in spikes; around 1 the flat back "
    "and seat bend; above 2 they stay flat, as with neural weights, but the borders between parts sharpen."
)


def run(lab: Lab) -> Report:
    """Deform the chair with each alpha."""
    sweep = classic_sweep(lab, "fig9", "alpha", {value: {"alpha": value} for value in ALPHAS}, 7, CAPTION)
    neural, report = sweep.neural.numbers, sweep.report
    small, usual, large = (sweep.classic[value].numbers for value in (0.1, 1.0, 5.0))
    report.claims += [
        Claim(
            "A small alpha gives spikes at the control points, a usual one bends flat parts.",
            f"Mean distance of the nearest vertices from their targets at alpha 0.1: {small['error']:.3f} (neural "
            f"{neural['error']:.4f}); median change of mean curvature at alpha 1: {usual['curvature_median']:.3g} "
            f"(neural {neural['curvature_median']:.3g}).",
            small["error"] > 3 * neural["error"] and usual["curvature_median"] > 2 * neural["curvature_median"],
        ),
        Claim(
            "A large alpha gives sharp borders between what the control points rule.",
            f"Symmetric Dirichlet energy at alpha 5: {large['dirichlet']:.2f} (neural {neural['dirichlet']:.2f}, "
            "4 is none).",
            large["dirichlet"] > neural["dirichlet"],
        ),
    ]
    near = [value for value, outcome in sweep.classic.items() if _as_good(outcome.numbers, neural)]
    said = ", ".join(f"{a:g}" for a in near)
    report.claims.append(
        Claim(
            "No alpha makes classic weights as good as neural ones.",
            f"With alpha {said} no measure is more than half above the neural one: a well-chosen alpha is one answer."
            if near
            else "With every alpha one of the measures is more than half above the neural one.",
            not near,
        )
    )
    return report


def _as_good(classic: dict[str, float], neural: dict[str, float]) -> bool:
    """Whether no measure is more than half above the neural one; of the Dirichlet energy, what it has above 4."""
    none = {"dirichlet": 4.0}
    return all(classic[name] - none.get(name, 0) <= 1.5 * (neural[name] - none.get(name, 0)) for name in SHOWN)
