"""Figure 2: weights of six control points on a line, before and after one of them moves."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from neuralmls import NeuralWeights
from neuralmls_research.experiments.reproduce import line, verdicts
from neuralmls_research.experiments.reproduce.drawing import COLOURS, draw_weights, plots
from neuralmls_research.experiments.reproduce.lab import Lab, classic_title
from neuralmls_research.experiments.reproduce.line import AFTER, BEFORE, MOVED, TEMPERATURES, X, weights_on_line
from neuralmls_research.experiments.reproduce.report import Claim, Conclusions, Picture, Report
from neuralmls_research.experiments.reproduce.words import span

Array = NDArray[np.float64]

STAY = [i for i in range(len(BEFORE)) if i != MOVED]
FAR = X[:, 0] < BEFORE[1, 0]
CUT = 20.0  # where the published script cuts the axis of raw weights


def run(lab: Lab) -> Report:
    """Draw raw and normalised weights before and after the move, and measure what it changes, peaks and plateaus."""
    before, after = line.networks(lab, BEFORE), line.networks(lab, AFTER)
    neural = [(weights_on_line(a), weights_on_line(b)) for a, b in zip(before, after, strict=True)]
    raw = line.raw_on_line(line.classic(BEFORE)), line.raw_on_line(line.classic(AFTER))
    normal = weights_on_line(line.classic(BEFORE)), weights_on_line(line.classic(AFTER))
    _draw_move(lab, neural[0], raw, normal)
    _draw_temperatures(lab, before[0])
    numbers = {
        "change_of_those_that_stay": {
            "neural": [_change(*pair) for pair in neural],
            "classic_raw": _change(*raw),
            "classic_normalised": _change(*normal),
        },
        "change_far_away": {
            "neural": [_change(*pair, FAR) for pair in neural],
            "classic_raw": _change(*raw, FAR),
            "classic_normalised": _change(*normal, FAR),
        },
        "peaks": {
            "neural": [max(map(line.peaks, a.T)) for a, _ in neural],
            "classic_raw": max(map(line.peaks, raw[0].T)),
            "classic_normalised": max(map(line.peaks, normal[0].T)),
        },
        "share_above_0.9": {"neural": [line.ruled(a) for a, _ in neural], "classic_normalised": line.ruled(normal[0])},
        "steepest": {
            f"T = {value:g}": [float(np.abs(line.slopes(weights_on_line(f, value))).max()) for f in before]
            for value in TEMPERATURES
        },
        "raw_peak": raw[0].max(axis=0).tolist(),
        "raw_between": float(raw[0].max(axis=1).min()),
        "raw_peak_off_by": np.abs(X[raw[0].argmax(axis=0), 0] - BEFORE[:, 0]).tolist(),
    }
    return Report(
        line.SETTING.format(width=lab.width, seeds=len(lab.seeds)),
        pictures=[
            Picture(
                "fig2-weights.png",
                "A curve for each control point, which the dot below of the same colour marks; below, the fourth has "
                "moved by -1, and broken lines are the curves of before. Left, neural weights: plateaus with soft "
                "borders, which move with it. Middle, classic weights as the paper draws them, raw (the axis is cut; "
                "the peaks are 10⁶ high): no other curve changes. Right, the same normalised, as moving least "
                "squares uses them: they change too.",
            ),
            Picture(
                "fig2-temperature.png",
                "One network at three temperatures. Above what it says, divided by T; in the middle the weights that "
                "the softmax makes of it; below how steep they are. A low temperature gives plateaus with steep "
                "borders, a high one hills.",
            ),
        ],
        claims=_claims(numbers),
        numbers=numbers,
    )


def _change(before: Array, after: Array, where: Array | slice = slice(None)) -> float:
    """The largest change of a weight of a control point that stays."""
    return float(np.abs(after - before)[where][:, STAY].max())


def _draw_move(lab: Lab, neural: Sequence[Array], raw: Sequence[Array], normal: Sequence[Array]) -> None:
    kinds = {
        "neural, T = 1": (neural, 1.05),
        f"{classic_title(line.ALPHA)}, raw": (raw, CUT),
        f"{classic_title(line.ALPHA)}, normalised": (normal, 1.05),
    }
    with plots(lab, "fig2-weights.png", 2, 3, (14, 5.6), sharex=True) as axes:
        for column, (kind, (w, top)) in zip(axes.T, kinds.items(), strict=True):
            draw_weights(column[0], X, w[0], BEFORE, kind, top)
            draw_weights(column[1], X, w[1], AFTER, "the fourth moved by -1", top, before=w[0])
            column[1].set_xlabel("x")
        for ax in axes[:, 0]:
            ax.set_ylabel("weight")


def _draw_temperatures(lab: Lab, function: NeuralWeights) -> None:
    rows = ("logits / T", "weight", "slope of the weight")
    with plots(lab, "fig2-temperature.png", 3, len(TEMPERATURES), (14, 7.6), sharex=True, sharey="row") as axes:
        for column, value in zip(axes.T, TEMPERATURES, strict=True):
            w = weights_on_line(function, value)
            for i, colour in enumerate(COLOURS[: w.shape[1]]):
                column[0].plot(X[:, 0], function.logits(X)[:, i] / value, color=colour)
                column[2].plot(X[:, 0], line.slopes(w)[:, i], color=colour)
            draw_weights(column[1], X, w, BEFORE, "")
            column[0].set_title(f"T = {value:g}")
            column[0].set_yscale("symlog", linthresh=10)
            column[2].set_yscale("symlog", linthresh=1)
            column[2].set_xlabel("x")
        for ax, name in zip(axes[:, 0], rows, strict=True):
            ax.set_ylabel(name)


def _claims(n: dict[str, Any]) -> list[Claim]:
    stay, far, most = n["change_of_those_that_stay"], n["change_far_away"], n["peaks"]
    ruled, steep = n["share_above_0.9"], n["steepest"]
    changed = [stay["classic_raw"]] if stay["classic_raw"] else []
    aware = verdicts.together(
        verdicts.no_value("of a raw classic weight of a control point that stays changes at all", changed),
        verdicts.above(0.1, stay["neural"]),
    )
    at_points = verdicts.in_all(
        f"a raw classic weight is largest within a step of the line ({line.STEP:g}) of its control point",
        [off <= line.STEP for off in n["raw_peak_off_by"]],
    )
    smooth = verdicts.together(
        verdicts.in_all("each neural weight has one peak, with every seed,", [count == 1 for count in most["neural"]]),
        verdicts.more("the share of the line that is ruled", ruled["neural"], ruled["classic_normalised"]),
    )
    nearby = verdicts.less("the change of neural weights", far["neural"], far["classic_normalised"])
    sharper = verdicts.in_all(
        "the steepest place is less steep at every higher temperature, with every seed,",
        [low > high for lower, higher in pairwise(steep.values()) for low, high in zip(lower, higher, strict=True)],
    )
    return [
        Claim(
            paper="Neural weights know where the other control points are: when one moves, the weights of the others "
            "change. Classic ones depend on the distance to one control point, and do not.",
            measure="The largest change, over the line, of a weight of a control point that stays: neural ones after "
            "the softmax, classic ones raw, as Figure 2 draws them.",
            measured=f"Neural {span(stay['neural'])} (of 1); raw classic {stay['classic_raw']:g}, exactly. "
            f"Normalised, classic ones change by {stay['classic_normalised']:.2f}.",
            ruling=aware,
            conclusions=Conclusions(
                "True of raw weights, by their formula. But moving least squares uses weights through their ratios "
                "alone (Proposition 1), and normalised classic weights change too: the figure compares curves that are "
                "not drawn alike.",
                "Not with every seed.",
                "Neural weights change no more than classic ones.",
            ),
        ),
        Claim(
            paper="Classic weights peak at their control points, and are flat and low between them.",
            measure="Where a raw classic weight is largest, and how large the largest of them is where it is least.",
            measured=f"The peaks are off by at most {max(n['raw_peak_off_by']):.2g} and up to "
            f"{max(n['raw_peak']):.3g} high; between control points the largest weight falls to "
            f"{n['raw_between']:.2g}.",
            ruling=at_points,
            conclusions=Conclusions(
                "The height of the peaks is 1/epsilon, and says nothing of a deformation: it cancels.",
                "Some peaks are beside their control points.",
                "The peaks are beside their control points.",
            ),
        ),
        Claim(
            paper="Neural weights are piecewise smooth: each control point rules one piece, with a soft border.",
            measure="Peaks of a neural weight; share of the line that is ruled, where one control point has over 0.9 "
            "of all weight.",
            measured=f"Neural: {span(most['neural'])} peak, {span(ruled['neural'], '{:.0%}')} of the line ruled, "
            f"steepest {span(steep['T = 1'])} a unit. Classic: {most['classic_raw']} peak raw, up to "
            f"{most['classic_normalised']} normalised, {ruled['classic_normalised']:.0%} ruled.",
            ruling=smooth,
            conclusions=Conclusions(
                "Plateaus with soft borders. Raw classic weights have one peak each as well; those behind other "
                "control points come with the normalisation.",
                "Plateaus, but not one to each control point with every seed.",
                "No plateaus: neural weights rule no more of the line than classic ones.",
            ),
        ),
        Claim(
            paper="The temperature sets how steep the borders are.",
            measure="The steepest place of a neural weight, softmax(logits / T), at T = 0.2, 1 and 5.",
            measured=", ".join(f"{label}: {span(values)}" for label, values in steep.items()) + " a unit.",
            ruling=sharper,
            conclusions=Conclusions(
                "Below 1 pieces with edges, far above 1 hills that no longer own their control point.",
                "Mostly, not between all temperatures and seeds.",
                "The temperature does not set it.",
            ),
            ours=True,
        ),
        Claim(
            paper="A move is felt nearby: far away neural weights change less than classic ones.",
            measure="The largest change left of the second control point, by a move of the fourth, normalised.",
            measured=f"Neural {span(far['neural'])}, classic {far['classic_normalised']:.3f}.",
            ruling=nearby,
            conclusions=Conclusions(
                "With these seeds a change stays in its surroundings, though nothing in the training makes it.",
                "Some networks keep a change to its surroundings, but nothing in the training makes them.",
                "Far away neural weights change more than classic ones.",
            ),
            ours=True,
        ),
    ]
