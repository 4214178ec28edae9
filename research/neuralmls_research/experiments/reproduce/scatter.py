"""Figure 6: distortion against control-point error, for every shape and displacement that is there."""

from __future__ import annotations

from collections.abc import Sequence
from statistics import fmean

from neuralmls_research.experiments.reproduce import verdicts
from neuralmls_research.experiments.reproduce.lab import Lab
from neuralmls_research.experiments.reproduce.outcomes import (
    BEYOND,
    CLASSIC_LABEL,
    KPD_LABEL,
    NARROW_LABEL,
    NEURAL_LABEL,
    STEEPER_LABEL,
    STEPS,
    narrow,
    numbers,
    ours,
)
from neuralmls_research.experiments.reproduce.report import Claim, Conclusions, Picture, Report
from neuralmls_research.experiments.reproduce.scatter_cases import (
    MEASURED,
    PAPERS,
    Case,
    against_neural,
    measured,
    of_all,
    wins,
)
from neuralmls_research.experiments.reproduce.scatter_drawing import draw
from neuralmls_research.experiments.reproduce.subjects import many
from neuralmls_research.experiments.reproduce.words import span

CATEGORIES = ("chair", "airplane", "car")  # the paper's
LEAST = 3  # deformations of a category, below which it has no verdict


def run(lab: Lab) -> Report:
    """Measure every case by every method that applies, networks with each seed."""
    subjects = many(lab)[:: 4 if lab.quick else 1]
    cases, everything = measured(lab, subjects)
    report = Report(
        f"{len(cases)} deformations; network of width {lab.width} with {len(lab.seeds)} seeds (the narrow one: width "
        f"{narrow(lab)}, as in the published code), {STEPS} steps, temperature 1; rigid. {BEYOND}"
    )
    for number, (subject, found) in enumerate(zip(subjects, everything, strict=True), 1):
        report.numbers[f"{number}: {subject.label}"] = numbers(found)
    for name in CATEGORIES:
        if any(subject.ours for subject in subjects if subject.name == name):
            # The data has none of the paper's cars either.
            where = "" if name == "car" else " ($NEURALMLS_DATA)"
            report.missing.append(f"The paper's {name}s: a shape that is not the paper's stands in{where}.")
    labels = (NEURAL_LABEL, NARROW_LABEL, CLASSIC_LABEL, STEEPER_LABEL, KPD_LABEL, "ARAP", *ours(lab))
    shown = [label for label in labels if any(label in case.values["error"] for case in cases)]
    draw(lab, "fig6-scatter.png", shown, cases)
    report.pictures.append(
        Picture(
            "fig6-scatter.png",
            "A mark for each deformation, networks with the mean of the seeds: to the left, control points arrive; "
            "below, the surface changes little. The lower left is best. Left, the paper's axis; right, the measure of "
            "Table 1. Marks of one shape can be compared, heights of different shapes cannot. Hollow marks are other "
            "settings of the published code; rings are ours.",
        )
    )
    report.tables += [of_all(measure, shown, cases) for measure in MEASURED[:4]]
    report.tables.append(against_neural([label for label in shown if label != NEURAL_LABEL], cases))
    papers = [case for case in cases if case.category in CATEGORIES]
    report.claims += [_distortion(name, [case for case in papers if case.category == name]) for name in CATEGORIES]
    report.claims += [_closeness(papers), _corner(papers), _steeper(cases), _narrower(cases), _study()]
    return report


def _distortion(category: str, cases: Sequence[Case]) -> Claim:
    ruling = verdicts.better_than_each([case.pairs("laplacian") for case in cases], LEAST)
    return Claim(
        paper=f"Figure 6, {category}s: neural weights distort less than the other methods.",
        measure="Mean change of the Laplacian's length, the figure's axis.",
        measured=_changes(cases) if cases else "Nothing: no such shape is here.",
        ruling=ruling,
        conclusions=Conclusions(
            "On this axis neural weights distort less in this category.",
            "It depends on the displacement, and on the method compared with: look at the rows.",
            "On this axis neural weights distort less than another method in no deformation of the category.",
        ),
    )


def _changes(cases: Sequence[Case]) -> str:
    """What became of a category on both measures of distortion."""
    classic = [case.against("laplacian", CLASSIC_LABEL) for case in cases]
    ratios = [fmean(neural) / other for neural, other in classic]
    return (
        f"Less than {_against('laplacian', cases)}; neural / classic {span(ratios, '{:.2f}')}. Beside it, mean "
        f"change of mean curvature: less than {_against('curvature', cases)}."
        + (" The shapes are no shapes of the paper, but stand in." if any(case.ours for case in cases) else "")
    )


def _closeness(cases: Sequence[Case]) -> Claim:
    ruling = verdicts.better_than_each([case.pairs("error") for case in cases], len(CATEGORIES) * LEAST)
    return Claim(
        paper="Figure 6: with neural weights control points come closer to their targets than with the other methods.",
        measure="Mean distance of the control points' nearest vertices from the targets, the figure's axis.",
        measured=f"Closer than {_against('error', cases)}.",
        ruling=ruling,
        conclusions=Conclusions(
            "Neural weights come closest.",
            "Neural weights mostly come closer than 1/d and KeypointDeformer, not always.",
            "Neural weights do not come closer.",
        ),
    )


def _corner(cases: Sequence[Case]) -> Claim:
    free = [not case.dominated() for case in cases]
    ruling = verdicts.in_all(
        "no other method of the paper has less on both axes than neural weights", free, len(CATEGORIES) * LEAST
    )
    both = sum(case.better_on_both(CLASSIC_LABEL) for case in cases)
    return Claim(
        paper="Figure 6: neural weights are the best trade of distortion against control-point error.",
        measure="Both axes of the figure.",
        measured=f"So it is in {sum(free)} of {len(free)}. Neural weights have less than {CLASSIC_LABEL} on both axes "
        f"in {both} of {len(cases)}.",
        ruling=ruling,
        conclusions=Conclusions(
            "Whoever wants less distortion has to accept a larger distance, and the other way round.",
            "Mostly a trade: less distortion for a larger distance. Seldom is one method better on both axes.",
            "Another method is better on both axes everywhere.",
        ),
    )


def _steeper(cases: Sequence[Case]) -> Claim:
    ruling = verdicts.better_in_all([case.against("error", STEEPER_LABEL) for case in cases], STEEPER_LABEL)
    return Claim(
        paper="Neural weights come closer to the targets than classic ones with the study's exponent, too.",
        measure="Mean distance of the control points' nearest vertices from the targets.",
        measured=f"Closer in {wins(cases, 'error', STEEPER_LABEL)}.",
        ruling=ruling,
        conclusions=Conclusions(
            "The network comes closer than a steeper exponent does.",
            "Closeness hangs on the exponent as much as on the network: 1/d^2 comes about as close.",
            "A steeper exponent comes closer than the network.",
        ),
        ours=True,
    )


def _narrower(cases: Sequence[Case]) -> Claim:
    ruling = verdicts.together(
        *(
            verdicts.better_in_all(
                [case.against(measure, CLASSIC_LABEL, NARROW_LABEL) for case in cases], CLASSIC_LABEL
            )
            for measure in ("laplacian", "error")
        )
    )
    less, closer = (wins(cases, measure, CLASSIC_LABEL, NARROW_LABEL) for measure in ("laplacian", "error"))
    return Claim(
        paper="The narrow network of the published code is better than classic weights on both axes.",
        measure="Both axes of the figure.",
        measured=f"Less change of the Laplacian in {less}, closer to the targets in {closer}.",
        ruling=ruling,
        conclusions=Conclusions(
            "It is better on both axes.",
            "Better on one axis, not on the other: compare the two, never one alone.",
            "It is better on neither axis.",
        ),
        ours=True,
    )


def _study() -> Claim:
    """The user study, which needs people: its deformations are those of the figure, of three shapes a category."""
    ruling = verdicts.untestable("it needs people who answer")
    return Claim(
        paper="Table 2, the user study: of three results (neural weights, classic ones, KeypointDeformer) for each of "
        "27 deformations of chairs, airplanes and cars, people find that of neural weights the most realistic.",
        measure="Share of the answers.",
        measured="Nothing: neuralmls study builds such a study and evaluates its answers; the measures above say "
        "nothing of what people find realistic.",
        ruling=ruling,
    )


def _against(measure: str, cases: Sequence[Case]) -> str:
    """In how many cases neural weights have less than each other method of the paper."""
    here = [label for label in PAPERS if any(label in case.values[measure] for case in cases)]
    return ", ".join(f"{label} in {wins(cases, measure, label)}" for label in here)
