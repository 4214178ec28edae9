"""Figure 6: distortion against control-point error, for every shape and displacement that is there."""

from __future__ import annotations

from statistics import median

from neuralmls.experiments.reproduce.drawing import COLOURS, plots
from neuralmls.experiments.reproduce.lab import Lab
from neuralmls.experiments.reproduce.outcomes import BEYOND, by_methods, numbers, ours, rivals
from neuralmls.experiments.reproduce.report import Claim, Picture, Report, Table
from neuralmls.experiments.reproduce.subjects import many

MARKS = {"chair": "o", "airplane": "^", "car": "s", "table": "D"}  # a star for anything else
Rows = dict[str, dict[str, float]]  # the measures of each method


def run(lab: Lab) -> Report:
    """Measure every case by every method that applies."""
    cases = many(lab)[:: 4 if lab.quick else 1]
    methods = ("neural", "classic MLS", "KeypointDeformer", "ARAP", *ours(lab))
    points: dict[str, list[tuple[str, float, float]]] = {name: [] for name in methods}
    report = Report(
        f"{len(cases)} deformations; network of width {lab.width}, 48 steps, temperature 1; classic weights 1/d; "
        f"rigid. {BEYOND}"
    )
    measured: list[Rows] = []
    for number, subject in enumerate(cases, 1):
        found, _ = by_methods(subject, rivals(lab, subject) | ours(lab))
        named = numbers(found)
        measured.append(named)
        for label, row in named.items():
            points[label].append((subject.name, row["error"], row["curvature"]))
        report.numbers[f"{number}: {subject.label}"] = named
    with plots(lab, "fig6-scatter.png", 1, 1, (8.5, 5.6)) as axes:
        ax = axes[0, 0]
        for colour, values in zip(COLOURS, points.values(), strict=False):
            for name, error, distortion in values:
                ax.plot(error, distortion, MARKS.get(name, "*"), color=colour, markersize=8, alpha=0.8)
        by_method = [
            ax.plot([], [], "o", color=colour, label=label)[0]
            for colour, (label, values) in zip(COLOURS, points.items(), strict=False)
            if values
        ]
        by_shape = [
            ax.plot([], [], mark, color="#777777", markerfacecolor="none", label=name)[0]
            for name, mark in {**MARKS, "organic": "*"}.items()
        ]
        ax.set(
            xscale="log",
            yscale="log",
            xlabel="mean distance of the control points' nearest vertices from the targets",
            ylabel="mean |Δ mean curvature|",
        )
        figure = ax.figure
        figure.legend(handles=by_method, loc="outside right upper", title="method", alignment="left")
        figure.legend(handles=by_shape, loc="outside right lower", title="shape", alignment="left")
    report.pictures.append(
        Picture(
            "fig6-scatter.png",
            "A mark for each deformation: to the left, control points arrive; below, the surface keeps its curvature. "
            "The lower left is best. Marks of the same shape can be compared, heights of different shapes cannot.",
        )
    )
    against = [_against_neural(label, measured) for label, values in points.items() if values and label != "neural"]
    head = ["method", "deformations", "less distortion", "closer to the targets"]
    head += ["ratio of the distortions, median", "ratio of the Dirichlet energies, median"]
    caption = "Each method against the paper's neural weights: in how many deformations it is better, and by how much."
    report.tables.append(Table(caption, head, against))
    compared = len(measured)
    less = sum(row["neural"]["curvature"] < row["classic MLS"]["curvature"] for row in measured)
    nearer = sum(row["neural"]["error"] < row["classic MLS"]["error"] for row in measured)
    report.claims.append(
        Claim(
            "Neural weights are closer to the best corner of the scatter than classic ones.",
            f"Of {compared} deformations, neural weights distort less in {less}, and come closer to the targets in "
            f"{nearer}.",
            less > compared / 2 and nearer > compared / 2,
        )
    )
    return report


def _against_neural(label: str, measured: list[Rows]) -> list[str]:
    """A row of the table: a method where it applies, beside the paper's neural weights there."""
    pairs = [(row[label], row["neural"]) for row in measured if label in row]
    better = [sum(other[name] < neural[name] for other, neural in pairs) for name in ("curvature", "error")]
    ratios = [median(other[name] / neural[name] for other, neural in pairs) for name in ("curvature", "dirichlet")]
    return [label, f"{len(pairs)}", *(f"{count}" for count in better), *(f"{ratio:.2f}" for ratio in ratios)]
