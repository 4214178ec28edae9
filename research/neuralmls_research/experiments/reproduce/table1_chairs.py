"""Table 1, the chair: which displacement is not said, so all that the authors published are run; and cars."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeAlias

from neuralmls_research.experiments.methods import Bound
from neuralmls_research.experiments.reproduce import verdicts
from neuralmls_research.experiments.reproduce.lab import Lab
from neuralmls_research.experiments.reproduce.outcomes import (
    CLASSIC_LABEL,
    COLUMNS,
    KPD_LABEL,
    NARROW_LABEL,
    NEURAL_LABEL,
    STEEPER_LABEL,
    Outcome,
    by_methods,
    numbers,
    rivals,
    seeds_of,
)
from neuralmls_research.experiments.reproduce.report import Claim, Conclusions, Report, Table
from neuralmls_research.experiments.reproduce.subjects import Subject, cars, chairs
from neuralmls_research.experiments.reproduce.verdicts import Ruling
from neuralmls_research.experiments.reproduce.words import span

LABELS = (NEURAL_LABEL, NARROW_LABEL, CLASSIC_LABEL, STEEPER_LABEL, KPD_LABEL)
LEAST = 3  # deformations, below which there is no verdict
Measured: TypeAlias = list[tuple[Subject, list[Outcome]]]


def of_chairs(lab: Lab, report: Report) -> Ruling:
    """Add the chairs.

    Returns
    -------
    what their rule says with the narrow network of the published code
    """
    measured = _add("chairs", lab, chairs(lab), report)
    report.claims.append(_chairs(measured))
    if any(subject.ours for subject, _ in measured):
        report.missing.append("The paper's chairs: our sample stands in ($NEURALMLS_DATA).")
    return verdicts.better_in_all(_against(measured, CLASSIC_LABEL, method=NARROW_LABEL), CLASSIC_LABEL, LEAST)


def of_cars(lab: Lab, report: Report) -> None:
    """Add cars, of which the data has none from the paper."""
    report.claims.append(_cars(_add("cars", lab, cars(lab), report)))


def _add(name: str, lab: Lab, subjects: Sequence[Subject], report: Report) -> Measured:
    measured = _measured(lab, subjects[:: 3 if lab.quick else 1])
    report.tables.append(_table(name, measured))
    report.numbers[name] = {subject.label: numbers(found) for subject, found in measured}
    return measured


def _measured(lab: Lab, subjects: Sequence[Subject]) -> Measured:
    found: Measured = []
    bound: dict[str, Bound] = {}
    for subject in subjects:
        if found and not subject.differs_by_displacement(found[-1][0]):
            bound = {}
        found.append((subject, by_methods(subject, rivals(lab, subject), bound)[0]))
    return found


def _table(name: str, measured: Measured) -> Table:
    rows = []
    for subject, found in measured:
        values = seeds_of(found, "curvature")
        cells = (span(values[label], COLUMNS["curvature"][1]) if label in values else "-" for label in LABELS)
        rows.append([subject.label, *cells])
    caption = "|Δ mean curvature|, mean: least and largest of the seeds; - where a method does not apply."
    return Table(f"table1-{name}", caption, ["deformation", *LABELS], rows)


def _against(
    measured: Measured, rival: str, measure: str = "curvature", method: str = NEURAL_LABEL
) -> list[tuple[list[float], float]]:
    values = [seeds_of(found, measure) for _, found in measured]
    return [(of[method], of[rival][0]) for of in values if rival in of]


def _wins(measured: Measured, rival: str, measure: str = "curvature") -> str:
    pairs = _against(measured, rival, measure)
    return f"{sum(max(neural) < other for neural, other in pairs)} of {len(pairs)}"


def _chairs(measured: Measured) -> Claim:
    ruling = verdicts.better_in_all(_against(measured, CLASSIC_LABEL), CLASSIC_LABEL, LEAST)
    first = seeds_of(measured[0][1], "curvature")
    return Claim(
        paper="Table 1, chair: neural weights distort less than classic ones (and than KeypointDeformer).",
        measure="Mean change of mean curvature.",
        measured=f"Less in {_wins(measured, CLASSIC_LABEL)}; {measured[0][0].label}: neural "
        f"{span(first[NEURAL_LABEL])}, classic {span(first[CLASSIC_LABEL])}. Of the Laplacian, less in "
        f"{_wins(measured, CLASSIC_LABEL, 'laplacian')}. KeypointDeformer has no weights for chairs here.",
        ruling=ruling,
        conclusions=Conclusions(
            "On chairs neural weights distort less than classic ones, by this measure.",
            "On chairs neural weights distort less with nearly every displacement, by this measure.",
            "On chairs neural weights do not distort less.",
        ),
    )


def _cars(measured: Measured) -> Claim:
    rivals_here = [label for label in (CLASSIC_LABEL, KPD_LABEL) if _against(measured, label)]
    each = [[pair for label in rivals_here for pair in _against([one], label)] for one in measured]
    ruling = verdicts.better_than_each(each, LEAST)
    return Claim(
        paper="On cars neural weights distort less than classic ones and KeypointDeformer, as in Table 1.",
        measure="Mean change of mean curvature.",
        measured="Less than "
        + ", ".join(f"{label} in {_wins(measured, label)}" for label in rivals_here)
        + f", on {measured[0][0].origin.partition(',')[0]}.",
        ruling=ruling,
        conclusions=Conclusions(
            "So it is on this car.",
            "Less than KeypointDeformer; against classic weights it depends on the displacement.",
            "Not so on this car.",
        ),
        ours=True,
    )
