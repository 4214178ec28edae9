"""Figure 8: neural weights at temperatures from 0.2 to 5, on several chairs."""

from __future__ import annotations

import numpy as np

from neuralmls import Deformer, NeuralWeights
from neuralmls_research.experiments.reproduce import verdicts
from neuralmls_research.experiments.reproduce.drawing import COLOURS, draw_shapes, plots
from neuralmls_research.experiments.reproduce.lab import Lab
from neuralmls_research.experiments.reproduce.outcomes import (
    COLUMNS,
    STEPS,
    Outcome,
    Setting,
    by_settings,
    numbers,
    table,
)
from neuralmls_research.experiments.reproduce.report import Claim, Conclusions, Picture, Report
from neuralmls_research.experiments.reproduce.subjects import Subject, chairs, plain_chair
from neuralmls_research.metrics import strain

Trade = dict[str, list[float]]  # a measure over the temperature

TEMPERATURES = (0.2, 0.3, 0.5, 0.8, 1.0, 2.0, 3.0, 4.0, 5.0)
DRAWN = (0.2, 1.0, 2.0, 5.0)  # of the chairs beside the paper's
MEASURES = ("error_at_points", "dirichlet")  # of the claim
SHOWN = ("error_at_points", "curvature_median", "dirichlet")


def run(lab: Lab) -> Report:
    """Deform each chair at each temperature, with one network a seed."""
    subjects, values = _chairs(lab), TEMPERATURES[:: 4 if lab.quick else 1]
    pictures, tables, found = [], [], {}
    for number, (name, subject) in enumerate(subjects.items()):
        outcomes = _sweep(lab, subject, values)
        found[name] = outcomes
        file = "fig8-temperature.png" if number == 0 else f"fig8-temperature-{number + 1}.png"
        shown = values if number == 0 else DRAWN
        drawn = {o.label: o.positions for value, o in zip(values, outcomes, strict=True) if value in shown}
        draw_shapes(lab, file, subject, drawn, 5)
        pictures.append(
            Picture(
                file,
                "Low temperatures reach the targets (blue) with parts that move as one and stretch little beside their "
                "borders; high ones spread the motion evenly and leave the targets behind."
                if number == 0
                else f"The same on another chair: {subject.label}.",
            )
        )
        caption = f"Over the temperature: {subject.label}."
        tables.append(table(f"fig8-temperature-{number + 1}", caption, "temperature", outcomes, SHOWN))
    first, *_ = subjects.values()
    others = {f"{first.origin}, seed {seed}": _trade(lab, first, values, seed) for seed in lab.seeds[1:]}
    drawn_ones = [subject.origin for subject in subjects.values()]
    others |= {s.origin: _trade(lab, s, values, lab.seeds[0]) for s in chairs(lab) if s.origin not in drawn_ones}
    _draw_curves(lab, values, found)
    pictures.append(
        Picture(
            "fig8-curves.png",
            "The same as curves, one a chair. With the temperature control points are missed by more, and the stretch "
            "spreads out, so that its energy falls.",
        )
    )
    return Report(
        f"{'; '.join(s.label for s in subjects.values())}. Networks of width {lab.width}, {STEPS} steps, rigid, each "
        f"evaluated at every temperature; the first seed is drawn. The verdict is on all {len(others) + len(found)} "
        f"sweeps: {len(lab.seeds)} seeds of the first chair, and every published task.",
        pictures=pictures,
        tables=tables,
        claims=[_claim(found, others)],
        numbers={name: numbers(outcomes) for name, outcomes in found.items()} | {"others": others},
        missing=next(iter(subjects.values())).missing,
    )


def _chairs(lab: Lab) -> dict[str, Subject]:
    """The chair of the paper's sweep, and one task of each other chair that the data has, by shape."""
    found: dict[str, Subject] = {}
    for subject in (plain_chair(lab), *chairs(lab)):
        found.setdefault(subject.origin.partition(",")[0].removeprefix("the paper's "), subject)
    return found


def _fit(lab: Lab, subject: Subject, seed: int) -> NeuralWeights:
    return NeuralWeights.fit(subject.points.sources, bounds=subject.bounds, width=lab.width, steps=STEPS, seed=seed)


def _sweep(lab: Lab, subject: Subject, values: tuple[float, ...]) -> list[Outcome]:
    """All measures at each temperature, of the first seed."""
    weights = _fit(lab, subject, lab.seeds[0])
    return by_settings(subject, [Setting(f"T = {value:g}", weights, value) for value in values])


def _trade(lab: Lab, subject: Subject, values: tuple[float, ...], seed: int) -> Trade:
    """The two measures of the claim alone, at each temperature."""
    weights, q = _fit(lab, subject, seed), subject.points.targets
    of_shape, of_points = Deformer(subject.positions, weights), Deformer(subject.points.sources, weights)
    shapes = [np.asarray(of_shape.deform(q, value), dtype=np.float64) for value in values]
    return {
        "error_at_points": [float(np.linalg.norm(of_points.deform(q, value) - q, axis=1).mean()) for value in values],
        "dirichlet": [strain(subject.positions, y, subject.faces).dirichlet_mean for y in shapes],
    }


def _draw_curves(lab: Lab, values: tuple[float, ...], found: dict[str, list[Outcome]]) -> None:
    with plots(lab, "fig8-curves.png", 1, len(SHOWN), (3.7 * len(SHOWN), 3.4)) as axes:
        for ax, name in zip(axes[0], SHOWN, strict=True):
            for colour, (label, outcomes) in zip(COLOURS, found.items(), strict=False):
                ax.plot(values, [o.numbers[name] for o in outcomes], "o-", color=colour, label=label)
            ax.set(xscale="log", yscale="log", xlabel="temperature", title=COLUMNS[name][0])
            ax.set_xticks(values[::2], [f"{value:g}" for value in values[::2]])
            ax.set_xticks([], minor=True)
        axes[0, 0].set_ylim(bottom=1e-6)
        axes[0, 0].legend(fontsize=8)


def _claim(found: dict[str, list[Outcome]], others: dict[str, Trade]) -> Claim:
    swept = [{name: [o.numbers[name] for o in outcomes] for name in MEASURES} for outcomes in found.values()]
    swept += others.values()
    rising = [verdicts.rises(sweep["error_at_points"]).verdict for sweep in swept]
    falling = [verdicts.falls(sweep["dirichlet"]).verdict for sweep in swept]
    trade = verdicts.together(
        verdicts.in_all(
            "the control-point error rises with every step of T, for every chair and seed,",
            [verdict is verdicts.Verdict.REPRODUCED for verdict in rising],
        ),
        verdicts.in_all(
            "the Dirichlet energy falls with every step of T, for every chair and seed,",
            [verdict is verdicts.Verdict.REPRODUCED for verdict in falling],
        ),
    )
    said = []
    for name, outcomes in found.items():
        low, high = outcomes[0].numbers, outcomes[-1].numbers
        said.append(
            f"{name}: error {low['error_at_points']:.1g} to {high['error_at_points']:.3f}, energy "
            f"{low['dirichlet']:.4g} to {high['dirichlet']:.4g}"
        )
    held = sum(verdict is verdicts.Verdict.REPRODUCED for verdict in falling)
    return Claim(
        paper="The temperature trades interpolation (low) for smooth approximation (high).",
        measure="Control-point error, and symmetric Dirichlet energy (4 is none), from T = 0.2 to 5.",
        measured="; ".join(said) + f". The energy falls throughout in {held} of {len(falling)} sweeps.",
        ruling=trade,
        conclusions=Conclusions(
            "The temperature chooses between the two.",
            "The temperature chooses between the two in most sweeps. In some the energy, which few slivers can make, "
            "rises between low temperatures before it falls.",
            "The temperature does not choose between the two.",
        ),
    )
