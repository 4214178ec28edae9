"""What became of a shape: deformed by methods or by weights, measured, drawn, and put into a table."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from neuralmls import Deformer, Weights
from neuralmls.errors import NotApplicable
from neuralmls.plugin import Transform
from neuralmls_research.experiments import methods
from neuralmls_research.experiments.methods import OURS, Method
from neuralmls_research.experiments.reproduce.drawing import CLASSIC, NEURAL, plots
from neuralmls_research.experiments.reproduce.lab import Lab
from neuralmls_research.experiments.reproduce.report import Table
from neuralmls_research.experiments.reproduce.subjects import Subject
from neuralmls_research.metrics import Measures, measure

Array = NDArray[np.float64]

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
    """A deformed shape and its measures."""

    label: str
    positions: Array
    measures: Measures

    @property
    def numbers(self) -> dict[str, float]:
        """The measures of a surface, by name."""
        m = self.measures
        assert m.curvature is not None
        assert m.laplacian is not None
        assert m.strain is not None
        assert m.flips is not None
        found = {
            "error": m.at_vertices,
            "curvature": m.curvature.mean,
            "curvature_median": m.curvature.median,
            "laplacian": m.laplacian.mean,
            "dirichlet": m.strain.dirichlet_mean,
            "flipped": m.flips.count,
        }
        return found if m.at_points is None else {**found, "error_at_points": m.at_points}


# What a table can show: a title, and how the number is printed.
COLUMNS = {
    "error": ("error at nearest vertices", "{:.4f}"),
    "error_at_points": ("error at control points", "{:.4f}"),
    "curvature": ("|Δ curvature|, mean", "{:.4g}"),
    "curvature_median": ("|Δ curvature|, median", "{:.3g}"),
    "laplacian": ("|Δ Laplacian|, mean", "{:.3g}"),
    "dirichlet": ("Dirichlet energy (4: none)", "{:.3f}"),
    "flipped": ("flipped triangles", "{:.0f}"),
}


def rivals(lab: Lab, subject: Subject) -> dict[str, Method]:
    """The methods of the paper's comparison, neural and classic first; KeypointDeformer where it knows the shape."""
    choice = {"neural": methods.neural(steps=48, width=lab.width), "classic MLS": methods.classic()}
    choice["ARAP"] = methods.METHODS["arap"]
    weights = None if subject.ours or subject.name != "airplane" else lab.keypoint_weights("airplane")
    if weights is not None:
        choice["KeypointDeformer"] = methods.kpd(weights)
    return choice


def ours(lab: Lab) -> dict[str, Method]:
    """What the package adds to the paper's method, to be shown beside it."""
    return {
        f"neural, exact {OURS}": methods.neural(steps=48, width=lab.width, adherence=1.0),
        f"shape-aware {OURS}": methods.shape_aware(),
        f"shape-aware, exact {OURS}": methods.shape_aware(adherence=1.0),
    }


def by_methods(subject: Subject, choice: Mapping[str, Method]) -> tuple[list[Outcome], dict[str, str]]:
    """Deform a shape with each method: what came of those that apply, and what the others say."""
    found, refusals = [], {}
    for label, method in choice.items():
        try:
            y = method(subject, subject.points.sources, subject.points.targets)
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
        found.append(Outcome(setting.label, y, replace(_measured(subject, y), at_points=missed)))
    return found


def _measured(subject: Subject, y: Array) -> Measures:
    return measure(subject.positions, y, subject.faces, subject.points.sources, subject.points.targets)


def table(name: str, caption: str, head: str, found: Sequence[Outcome], columns: Sequence[str]) -> Table:
    """The measures of outcomes, those that `columns` names."""
    rows = [[o.label, *(COLUMNS[column][1].format(o.numbers[column]) for column in columns)] for o in found]
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
