"""The deformations of Figure 6, what each method made of them, and the tables of all of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from statistics import fmean, median

from neuralmls_research.experiments.methods import Bound
from neuralmls_research.experiments.reproduce.lab import Lab
from neuralmls_research.experiments.reproduce.outcomes import (
    CLASSIC_LABEL,
    COLUMNS,
    KPD_LABEL,
    NEURAL_LABEL,
    Outcome,
    by_methods,
    ours,
    rivals,
    seeds_of,
)
from neuralmls_research.experiments.reproduce.report import Table
from neuralmls_research.experiments.reproduce.subjects import Subject
from neuralmls_research.experiments.reproduce.words import span

PAPERS = (CLASSIC_LABEL, KPD_LABEL, "ARAP")  # what the paper compares with
MEASURED = ("laplacian", "error", "curvature", "curvature_median", "dirichlet")


@dataclass(frozen=True)
class Case:
    """A deformation: its category, its label, and by measure and method a value for each seed.

    `ours` where the shape stands in for one of the paper's.
    """

    category: str
    label: str
    values: dict[str, dict[str, list[float]]]
    ours: bool = False

    @classmethod
    def of(cls, subject: Subject, found: Sequence[Outcome]) -> Case:
        """What methods made of a subject."""
        values = {measure: seeds_of(found, measure) for measure in MEASURED}
        return cls(subject.name, subject.label, values, subject.ours)

    def of_others(self, measure: str) -> dict[str, float]:
        """The paper's other methods, where they apply."""
        return {label: self.values[measure][label][0] for label in PAPERS if label in self.values[measure]}

    def against(self, measure: str, rival: str, method: str = NEURAL_LABEL) -> tuple[list[float], float]:
        """Neural weights with each seed, and a rival."""
        return self.values[measure][method], self.values[measure][rival][0]

    def pairs(self, measure: str) -> list[tuple[list[float], float]]:
        """Neural weights with each seed against each of the paper's other methods."""
        return [self.against(measure, label) for label in self.of_others(measure)]

    def better_on_both(self, rival: str) -> bool:
        """Whether neural weights, with every seed, have less than the rival on both axes of the figure."""
        both = (self.against(measure, rival) for measure in ("laplacian", "error"))
        return all(max(neural) < other for neural, other in both)

    def dominated(self) -> bool:
        """Whether another method of the paper has less than neural weights, with every seed, on both axes."""
        least = {measure: min(self.values[measure][NEURAL_LABEL]) for measure in ("laplacian", "error")}
        return any(
            all(self.of_others(measure)[label] < neural for measure, neural in least.items())
            for label in self.of_others("laplacian")
        )


def measured(lab: Lab, subjects: Sequence[Subject]) -> tuple[list[Case], list[list[Outcome]]]:
    """Every subject by every method that applies; displacements of one shape that follow each other train once."""
    cases, everything = [], []
    bound: dict[str, Bound] = {}
    before: Subject | None = None
    for subject in subjects:
        if before is None or not subject.differs_by_displacement(before):
            bound = {}
        before = subject
        found, _ = by_methods(subject, rivals(lab, subject) | ours(lab), bound)
        cases.append(Case.of(subject, found))
        everything.append(found)
    return cases, everything


def wins(cases: Sequence[Case], measure: str, rival: str, method: str = NEURAL_LABEL) -> str:
    """In how many of the cases that a rival does a method has less than it with every seed."""
    pairs = [case.against(measure, rival, method) for case in cases if rival in case.values[measure]]
    return f"{sum(max(values) < other for values, other in pairs)} of {len(pairs)}"


def of_all(measure: str, shown: Sequence[str], cases: Sequence[Case]) -> Table:
    """A row a deformation, a column a method."""

    def cell(case: Case, label: str) -> str:
        values = case.values[measure].get(label)
        return "-" if values is None else span(values, COLUMNS[measure][1])

    rows = [[f"{i}: {case.label}", *(cell(case, label) for label in shown)] for i, case in enumerate(cases, 1)]
    caption = (
        f"{COLUMNS[measure][0]}, in all deformations; of several seeds the least and the largest; - where "
        "a method does not apply."
    )
    return Table(f"fig6-{measure.replace('_', '-')}", caption, ["deformation", *shown], rows)


def against_neural(labels: Sequence[str], cases: Sequence[Case]) -> Table:
    """A row a method: where it applies, beside the paper's neural weights there, in the mean over seeds."""
    rows = []
    for label in labels:
        both = {
            measure: [
                (fmean(case.values[measure][label]), fmean(case.values[measure][NEURAL_LABEL]))
                for case in cases
                if label in case.values[measure]
            ]
            for measure in MEASURED
        }
        better = (sum(a < b for a, b in both[measure]) for measure in ("laplacian", "curvature", "error"))
        ratios = (median(a / b for a, b in both[measure]) for measure in ("laplacian", "curvature", "dirichlet"))
        rows.append([label, f"{len(both['error'])}", *map(str, better), *(f"{ratio:.2f}" for ratio in ratios)])
    head = ["method", "deformations", "less |Δ Laplacian|", "less |Δ curvature|", "closer to the targets"]
    head += [f"median ratio of {name}" for name in ("|Δ Laplacian|", "|Δ curvature|", "Dirichlet energies")]
    caption = "Each method against the paper's neural weights: in how many deformations it is better, and by how much."
    return Table("fig6-methods", caption, head, rows)
