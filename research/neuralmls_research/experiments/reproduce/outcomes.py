"""What became of a shape: deformed by methods or by weights, measured, drawn, and put into a table."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from neuralmls import Deformer, Weights
from neuralmls.errors import NotApplicable
from neuralmls.plugin import Transform
from neuralmls_research.experiments import methods
from neuralmls_research.experiments.methods import OURS, Bound, Method
from neuralmls_research.experiments.reproduce.drawing import CLASSIC, NEURAL, plots
from neuralmls_research.experiments.reproduce.lab import Lab, classic_title
from neuralmls_research.experiments.reproduce.report import Table
from neuralmls_research.experiments.reproduce.subjects import Subject
from neuralmls_research.experiments.reproduce.words import span
from neuralmls_research.metrics import curvature_change, flipped_triangles, handle_errors, strain

Array = NDArray[np.float64]

STEPS = 48  # of the published scripts: the paper says nothing of steps and rate
NEURAL_LABEL, NARROW_LABEL, KPD_LABEL = "neural", "neural, narrow network", "KeypointDeformer"
CLASSIC_LABEL, STEEPER_LABEL = classic_title(0.5), classic_title(1.0)  # the published comparison's, and its study's
SEED = ", seed "  # between the label of a network's outcome and its seed

BEYOND = (
    f"What is marked {OURS} is not in the paper: handles that arrive (exact), weights taught by random walks over the "
    "shape (shape-aware); see docs/notes/beyond-the-paper.md."
)


@dataclass(frozen=True)
class Setting:
    """Weights as a sweep uses them: with a temperature and a transform."""

    label: str
    weights: Weights
    temperature: float = 1.0
    transform: Transform = "rigid"


@dataclass(frozen=True)
class Outcome:
    """A deformed shape and its measures by name: `COLUMNS` says which."""

    label: str
    positions: Array
    numbers: dict[str, float]


# What a table can show: a title, and how the number is printed.
COLUMNS = {
    "error": ("error at nearest vertices", "{:.4f}"),
    "error_at_points": ("error at control points", "{:.4f}"),
    "curvature": ("|Δ curvature|, mean", "{:.4g}"),
    "curvature_median": ("|Δ curvature|, median", "{:.3g}"),
    "laplacian": ("|Δ Laplacian|, mean", "{:.4f}"),
    "dirichlet": ("Dirichlet energy (4: none)", "{:.3f}"),
    "flipped": ("flipped triangles", "{:.0f}"),
}


def rivals(lab: Lab, subject: Subject) -> dict[str, Method]:
    """The methods of the paper's comparison: neural with each seed, classic, ARAP; KeypointDeformer with its weights.

    Beside them what the published code would use: a narrower network, and in its study a steeper exponent.
    """
    choice = {
        f"{label}{SEED}{seed}": methods.neural(steps=STEPS, width=width, seed=seed)
        for label, width in ((NEURAL_LABEL, lab.width), (NARROW_LABEL, narrow(lab)))
        for seed in lab.seeds
    }
    choice |= {CLASSIC_LABEL: methods.classic(alpha=0.5), STEEPER_LABEL: methods.classic(alpha=1.0)}
    choice["ARAP"] = methods.METHODS["arap"]
    weights = lab.keypoint_weights(subject.name)
    if weights is not None:
        choice[KPD_LABEL] = methods.kpd(weights)
    return choice


def narrow(lab: Lab) -> int:
    """The width that the published code has without Fourier features: an eighth of the paper's 1024."""
    return lab.width // 8


def ours(lab: Lab) -> dict[str, Method]:
    """What the package adds to the paper's method, to be shown beside it."""
    return {
        f"neural, exact {OURS}": methods.neural(steps=STEPS, width=lab.width, adherence=1.0),
        f"shape-aware {OURS}": methods.shape_aware(),
        f"shape-aware, exact {OURS}": methods.shape_aware(adherence=1.0),
    }


def by_methods(
    subject: Subject, choice: Mapping[str, Method], bound: dict[str, Bound] | None = None
) -> tuple[list[Outcome], dict[str, str]]:
    """Deform a shape with each method: what came of those that apply, and what the others say.

    `bound` keeps what does not depend on the displacement, for the next one of the same shape and control points.
    """
    bound = {} if bound is None else bound
    found, refusals = [], {}
    for label, method in choice.items():
        try:
            if label not in bound:
                bound[label] = method.bind(subject, subject.points.sources)
            y = bound[label].positions(subject.points.targets)
        except NotApplicable as refusal:
            refusals[label] = str(refusal)
        else:
            found.append(Outcome(label, y, _measured(subject, y)))
    return found, refusals


def by_settings(subject: Subject, settings: Sequence[Setting]) -> list[Outcome]:
    """Deform a shape with each setting, and measure at the control points too."""
    p, q = subject.points.sources, subject.points.targets
    found = []
    for setting in settings:

        def moved(x: Array, setting: Setting = setting) -> Array:
            deformer = Deformer(x, setting.weights, transform=setting.transform)
            return np.asarray(deformer.deform(q, setting.temperature), dtype=np.float64)

        y = moved(subject.positions)
        missed = float(np.linalg.norm(moved(p) - q, axis=1).mean())
        found.append(Outcome(setting.label, y, {**_measured(subject, y), "error_at_points": missed}))
    return found


def _measured(subject: Subject, y: Array) -> dict[str, float]:
    """The measures of a surface, by name. The subject's half side is 1, which is the paper's unit."""
    x, faces, points = subject.positions, subject.faces, subject.points
    curvature, laplacian = curvature_change(x, y, faces)
    return {
        "error": float(handle_errors(x, y, points.sources, points.targets).mean()),
        "curvature": curvature.mean,
        "curvature_median": curvature.median,
        "laplacian": laplacian.mean,
        "dirichlet": strain(x, y, faces).dirichlet_mean,
        "flipped": flipped_triangles(x, y, faces).count,
    }


def group(found: Sequence[Outcome]) -> dict[str, list[Outcome]]:
    """Outcomes by their label without the seed: one for each seed of a network, else one."""
    groups: dict[str, list[Outcome]] = {}
    for outcome in found:
        groups.setdefault(outcome.label.partition(SEED)[0], []).append(outcome)
    return groups


def seeds_of(found: Sequence[Outcome], column: str) -> dict[str, list[float]]:
    """A measure by label, a value for each seed."""
    return {label: [outcome.numbers[column] for outcome in outcomes] for label, outcomes in group(found).items()}


def first_of(found: Sequence[Outcome]) -> dict[str, Array]:
    """The positions by label, of the first seed: what is drawn."""
    return {label: outcomes[0].positions for label, outcomes in group(found).items()}


def table(name: str, caption: str, head: str, found: Sequence[Outcome], columns: Sequence[str]) -> Table:
    """The measures of outcomes, those that `columns` names; of a network with several seeds the least and largest."""
    rows = [
        [label, *(span([o.numbers[column] for o in outcomes], COLUMNS[column][1]) for column in columns)]
        for label, outcomes in group(found).items()
    ]
    return Table(name, caption, [head, *(COLUMNS[column][0] for column in columns)], rows)


def numbers(found: Sequence[Outcome]) -> dict[str, dict[str, float]]:
    """The measures of all outcomes, for machines."""
    return {outcome.label: outcome.numbers for outcome in found}


def draw_curves(
    lab: Lab,
    file: str,
    parameter: str,
    values: Sequence[float],
    found: Sequence[Outcome],
    columns: Sequence[str],
    reference: Outcome | None = None,
) -> None:
    """Draw measures over the values of a parameter, and those of a reference as a broken line."""
    with plots(lab, file, 1, len(columns), (3.7 * len(columns), 3)) as axes:
        for ax, name in zip(axes[0], columns, strict=True):
            ax.plot(values, [outcome.numbers[name] for outcome in found], "o-", color=CLASSIC if reference else NEURAL)
            ax.set(xscale="log", xlabel=parameter, title=COLUMNS[name][0])
            ax.set_xticks(values[::2], [f"{value:g}" for value in values[::2]])
            ax.set_xticks([], minor=True)
            if reference is not None:
                ax.axhline(reference.numbers[name], color=NEURAL, linestyle="--", label=reference.label)
                ax.legend()
