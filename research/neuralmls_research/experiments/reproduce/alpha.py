"""Figure 9: classic weights with exponents from 0.05 to 5."""

from __future__ import annotations

from neuralmls_research.experiments.reproduce import verdicts
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
    spikes = verdicts.together(
        verdicts.less("the neural value", [neural["error"]], factor=3, rival=small["error"]),
        verdicts.less("the neural value", [neural["curvature_median"]], factor=2, rival=usual["curvature_median"]),
    )
    sharp = verdicts.less("the neural energy", [neural["dirichlet"]], large["dirichlet"])
    report.claims += [
        Claim(
            paper="A small alpha gives spikes at the control points, a usual one bends flat parts.",
            measure="How far nearest vertices stay from targets; the median change of mean curvature.",
            rule=spikes.rule,
            measured=f"Mean distance of the nearest vertices from their targets at alpha 0.1: {small['error']:.3f} "
            f"(neural "
            f"{neural['error']:.4f}); median change of mean curvature at alpha 1: {usual['curvature_median']:.3g} "
            f"(neural {neural['curvature_median']:.3g}).",
            verdict=spikes.verdict,
            reader="Both are seen.",
        ),
        Claim(
            paper="A large alpha gives sharp borders between what the control points rule.",
            measure="Symmetric Dirichlet energy.",
            rule=sharp.rule,
            measured=f"Symmetric Dirichlet energy at alpha 5: {large['dirichlet']:.2f} (neural "
            f"{neural['dirichlet']:.2f}, "
            "4 is none).",
            verdict=sharp.verdict,
            reader="Borders sharpen.",
        ),
    ]
    near = [value for value, outcome in sweep.classic.items() if _as_good(outcome.numbers, neural)]
    said = ", ".join(f"{a:g}" for a in near)
    none = verdicts.no_value("of alpha keeps every measure within half above the neural one", near)
    report.claims.append(
        Claim(
            paper="No alpha makes classic weights as good as neural ones.",
            measure="All measures of the table.",
            rule=none.rule,
            measured=f"With alpha {said} no measure is more than half above the neural one: a well-chosen alpha is "
            f"one answer."
            if near
            else "With every alpha one of the measures is more than half above the neural one.",
            verdict=none.verdict,
            reader="A well-chosen alpha is one answer.",
        )
    )
    return report


def _as_good(classic: dict[str, float], neural: dict[str, float]) -> bool:
    """Whether no measure is more than half above the neural one; of the Dirichlet energy, what it has above 4."""
    none = {"dirichlet": 4.0}
    return all(classic[name] - none.get(name, 0) <= 1.5 * (neural[name] - none.get(name, 0)) for name in SHOWN)
