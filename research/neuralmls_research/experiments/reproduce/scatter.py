"""Figure 6: distortion against control-point error, for every shape and displacement that is there."""

from __future__ import annotations

from statistics import median

from neuralmls_research.experiments.methods import OURS
from neuralmls_research.experiments.reproduce import verdicts
from neuralmls_research.experiments.reproduce.drawing import COLOURS, plots
from neuralmls_research.experiments.reproduce.lab import Lab
from neuralmls_research.experiments.reproduce.outcomes import BEYOND, by_methods, numbers, ours, rivals
from neuralmls_research.experiments.reproduce.report import Claim, Picture, Report, Table
from neuralmls_research.experiments.reproduce.subjects import many

MARKS = {"chair": "o", "airplane": "^", "car": "s", "table": "D"}  # a star for anything else
Rows = dict[str, dict[str, float]]  # the measures of each method


def run(lab: Lab) -> Report:
    """Measure every case by every method that applies."""
    cases = many(lab)[:: 4 if lab.quick else 1]
    report = Report(
        f"{len(cases)} deformations; network of width {lab.width}, 48 steps, temperature 1; classic weights 1/d; "
        f"rigid. {BEYOND}"
    )
    measured: list[tuple[str, Rows]] = []
    for number, subject in enumerate(cases, 1):
        found, _ = by_methods(subject, rivals(lab, subject) | ours(lab))
        rows = numbers(found)
        measured.append((subject.name, rows))
        report.numbers[f"{number}: {subject.label}"] = rows
    labels = ("neural", "classic MLS", "KeypointDeformer", "ARAP", *ours(lab))
    shown = [label for label in labels if any(label in rows for _, rows in measured)]
    _draw(lab, "fig6-scatter.png", shown, measured)
    report.pictures.append(
        Picture(
            "fig6-scatter.png",
            "A mark for each deformation: to the left, control points arrive; below, the surface keeps its curvature. "
            "The lower left is best. Marks of the same shape can be compared, heights of different shapes cannot. "
            "Rings are ours.",
        )
    )
    against = [_against_neural(label, measured) for label in shown if label != "neural"]
    head = ["method", "deformations", "less distortion", "closer to the targets"]
    head += ["ratio of the distortions, median", "ratio of the Dirichlet energies, median"]
    caption = "Each method against the paper's neural weights: in how many deformations it is better, and by how much."
    report.tables.append(Table("fig6-methods", caption, head, against))
    compared = len(measured)
    less = sum(rows["neural"]["curvature"] < rows["classic MLS"]["curvature"] for _, rows in measured)
    nearer = sum(rows["neural"]["error"] < rows["classic MLS"]["error"] for _, rows in measured)
    corner = verdicts.together(
        *(
            verdicts.better_in_all(key, [([rows["neural"][key]], rows["classic MLS"][key]) for _, rows in measured])
            for key in ("curvature", "error")
        )
    )
    report.claims.append(
        Claim(
            paper="Neural weights are closer to the best corner of the scatter than classic ones.",
            measure="Mean change of mean curvature against control-point error.",
            rule=corner.rule,
            measured=f"Of {compared} deformations, neural weights distort less in {less}, and come closer to the "
            f"targets in "
            f"{nearer}.",
            verdict=corner.verdict,
            reader="Often, not always.",
        )
    )
    return report


def _draw(lab: Lab, file: str, labels: list[str], measured: list[tuple[str, Rows]]) -> None:
    """Draw a colour a method, a mark a shape; ours are rings, each around the one before, as they often meet."""
    from matplotlib.ticker import LogLocator, NullFormatter

    rings = [label for label in labels if OURS in label]
    styles = {
        label: {"color": colour, "markersize": 8.0, "alpha": 0.8}
        for label, colour in zip(labels, COLOURS, strict=False)
    }
    for number, label in enumerate(rings):
        styles[label] |= {"markersize": 10.0 + 3 * number, "markerfacecolor": "none", "markeredgewidth": 1.5}
    with plots(lab, file, 1, 1, (8.5, 5.6)) as axes:
        ax = axes[0, 0]
        for label, style in styles.items():
            for name, rows in measured:
                if label in rows:
                    ax.plot(rows[label]["error"], rows[label]["curvature"], MARKS.get(name, "*"), **style)
        by_method = [ax.plot([], [], "o", label=label, **style)[0] for label, style in styles.items()]
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
        ax.xaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
        ax.xaxis.set_major_formatter("{x:g}")
        ax.xaxis.set_minor_formatter(NullFormatter())
        figure = ax.figure
        figure.legend(handles=by_method, loc="outside right upper", title="method", alignment="left")
        figure.legend(handles=by_shape, loc="outside right lower", title="shape", alignment="left")


def _against_neural(label: str, measured: list[tuple[str, Rows]]) -> list[str]:
    """A row of the table: a method where it applies, beside the paper's neural weights there."""
    pairs = [(rows[label], rows["neural"]) for _, rows in measured if label in rows]
    better = [sum(other[name] < neural[name] for other, neural in pairs) for name in ("curvature", "error")]
    ratios = [median(other[name] / neural[name] for other, neural in pairs) for name in ("curvature", "dirichlet")]
    return [label, f"{len(pairs)}", *(f"{count}" for count in better), *(f"{ratio:.2f}" for ratio in ratios)]
