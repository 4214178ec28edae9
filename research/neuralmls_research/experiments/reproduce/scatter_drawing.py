"""The picture of Figure 6: the paper's axis, and ours beside it."""

from __future__ import annotations

from collections.abc import Sequence
from statistics import fmean
from typing import Any

from neuralmls_research.experiments.methods import OURS
from neuralmls_research.experiments.reproduce.drawing import COLOURS, plots
from neuralmls_research.experiments.reproduce.lab import Lab
from neuralmls_research.experiments.reproduce.outcomes import (
    CLASSIC_LABEL,
    COLUMNS,
    NARROW_LABEL,
    NEURAL_LABEL,
    STEEPER_LABEL,
)
from neuralmls_research.experiments.reproduce.scatter_cases import Case

MARKS = {"chair": "o", "airplane": "^", "car": "s", "table": "D"}  # a star for anything else
AXES = {"laplacian": "the paper's axis", "curvature": "another measure, beside it"}
# What differs from another method by a setting alone is hollow, in its colour.
LIKE = {NARROW_LABEL: NEURAL_LABEL, STEEPER_LABEL: CLASSIC_LABEL}


def draw(lab: Lab, file: str, labels: Sequence[str], cases: Sequence[Case]) -> None:
    """Draw a colour a method, a mark a shape; ours are rings, each around the one before, as they often meet."""
    from matplotlib.ticker import LogLocator, NullFormatter

    styles = _styles(labels)
    with plots(lab, file, 1, 2, (13.5, 5.6)) as axes:
        for ax, (measure, whose) in zip(axes[0], AXES.items(), strict=True):
            for label, style in styles.items():
                for case in cases:
                    if label in case.values["error"]:
                        at = fmean(case.values["error"][label]), fmean(case.values[measure][label])
                        ax.plot(*at, MARKS.get(case.category, "*"), **style)
            ax.set(
                xscale="log",
                yscale="log",
                xlabel="mean distance of the control points' nearest vertices from the targets",
                ylabel=COLUMNS[measure][0],
                title=whose,
            )
            ax.xaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
            ax.xaxis.set_major_formatter("{x:g}")
            ax.xaxis.set_minor_formatter(NullFormatter())
        by_method = [ax.plot([], [], "o", label=label, **style)[0] for label, style in styles.items()]
        by_shape = [
            ax.plot([], [], mark, color="#777777", markerfacecolor="none", label=name)[0]
            for name, mark in {**MARKS, "organic": "*"}.items()
        ]
        ax.figure.legend(handles=by_method, loc="outside right upper", title="method", alignment="left")
        ax.figure.legend(handles=by_shape, loc="outside right lower", title="shape", alignment="left")


def _styles(labels: Sequence[str]) -> dict[str, dict[str, Any]]:
    own = [label for label in labels if label not in LIKE]
    styles: dict[str, dict[str, Any]] = {}
    for label in labels:
        colour = COLOURS[own.index(LIKE.get(label, label))]
        styles[label] = {"color": colour, "markersize": 8.0, "alpha": 0.8}
        if label in LIKE or OURS in label:
            styles[label] |= {"markerfacecolor": "none", "markeredgewidth": 1.5}
    for number, label in enumerate(label for label in labels if OURS in label):
        styles[label]["markersize"] = 10.0 + 3 * number
    return styles
