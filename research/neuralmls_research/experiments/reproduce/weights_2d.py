"""Weights of a square of four control points, before and after one of them moves inside."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from neuralmls import InverseDistanceWeights, NeuralWeights, softmax
from neuralmls_research.experiments.reproduce import verdicts
from neuralmls_research.experiments.reproduce.drawing import plots
from neuralmls_research.experiments.reproduce.lab import Lab, classic_title
from neuralmls_research.experiments.reproduce.report import Claim, Conclusions, Picture, Report
from neuralmls_research.experiments.reproduce.words import span

Array = NDArray[np.float64]

HALF = 0.3
BEFORE = np.array([[-HALF, -HALF], [HALF, -HALF], [-HALF, HALF], [HALF, HALF]])
AFTER = np.array([*BEFORE[:3], [0.1, 0.15]])
PLACES = {"before": BEFORE, "after": AFTER}
CUT = 20.0  # where the colours of raw weights end
CORNERS = ("lower left", "lower right", "upper left", "upper right")


def run(lab: Lab) -> Report:
    """Draw the weights, and measure how much of the square each control point rules."""
    side = 41 if lab.quick else 201
    axis = np.linspace(-HALF, HALF, side)
    grid = np.stack(np.meshgrid(axis, axis), axis=-1).reshape(-1, 2)
    bounds = [[-HALF, -HALF], [HALF, HALF]]
    neural: dict[str, list[Array]] = {}
    raw: dict[str, Array] = {}
    normal: dict[str, Array] = {}
    for when, p in PLACES.items():
        fits = [NeuralWeights.fit(p, bounds=bounds, width=lab.width, steps=72, seed=seed) for seed in lab.seeds]
        neural[when] = [np.asarray(softmax(fit.logits(grid)), dtype=np.float64) for fit in fits]
        # bounds of half a side of 1, so that d is the distance on the square itself
        logits = InverseDistanceWeights(p, alpha=0.5, epsilon=1e-8, bounds=[[-1, -1], [1, 1]]).logits(grid)
        raw[when], normal[when] = np.exp(logits.astype(np.float64)), np.asarray(softmax(logits), dtype=np.float64)
    title = classic_title(0.5)
    rows = {
        (f"{kind}\n{when}", when): (w[when], top)
        for kind, w, top in (
            ("neural", {when: found[0] for when, found in neural.items()}, 1.0),
            (f"{title}\nraw", raw, CUT),
            (f"{title}\nnormalised", normal, 1.0),
        )
        for when in PLACES
    }
    _draw(lab, side, rows)
    numbers = {
        "share_ruled": {when: [_rules(w)[3] for w in found] for when, found in neural.items()},
        "share_above_0.9": {
            "neural": [float((w.max(axis=1) > 0.9).mean()) for w in neural["after"]],
            "classic": float((normal["after"].max(axis=1) > 0.9).mean()),
        },
        "change_of_those_that_stay": {
            "neural": [_change(a, b) for a, b in zip(neural["before"], neural["after"], strict=True)],
            "classic_raw": _change(raw["before"], raw["after"]),
            "classic_normalised": _change(normal["before"], normal["after"]),
        },
    }
    return Report(
        f"Grid of {side} x {side} points on the square [-0.3, 0.3]² of the published script; networks of width "
        f"{lab.width}, 72 steps, temperature 1, {len(lab.seeds)} seeds, of which the first is drawn; classic weights "
        "1/(d + 10⁻⁸), which the published script does not draw. The upper right control point moves to (0.1, 0.15).",
        pictures=[
            Picture(
                "square-weights.png",
                "A column for each control point (orange), a row for each configuration: its weight from 0 (dark) to 1 "
                f"(bright), raw classic ones to {CUT:g} or more. The upper right one moves inwards: neural regions "
                "re-form as a whole, each connected. Raw classic weights of the others stay as they were; normalised "
                "they change too, and are bright at their control point alone.",
            )
        ],
        claims=[_claim(numbers)],
        numbers=numbers,
    )


def _rules(w: Array) -> list[float]:
    """The share of the grid where each control point has the largest weight (n, m)."""
    found: list[float] = (np.bincount(w.argmax(axis=1), minlength=w.shape[1]) / len(w)).tolist()
    return found


def _change(before: Array, after: Array) -> float:
    """The largest change of a weight of a control point that stays."""
    return float(np.abs(after - before)[:, :3].max())


def _draw(lab: Lab, side: int, rows: Mapping[tuple[str, str], tuple[Array, float]]) -> None:
    with plots(lab, "square-weights.png", len(rows), 4, (8.8, 11.4), sharex=True, sharey=True) as axes:
        for row, ((name, when), (w, top)) in zip(axes, rows.items(), strict=True):
            p = PLACES[when]
            for i, ax in enumerate(row):
                image = ax.imshow(
                    w[:, i].reshape(side, side),
                    origin="lower",
                    extent=(-HALF, HALF, -HALF, HALF),
                    vmin=0,
                    vmax=top,
                    cmap="viridis",
                )
                ax.plot(*p.T, "o", color="white", markeredgecolor="black", markersize=5, clip_on=False)
                ax.plot(*p[i], "o", color="#d55e00", markeredgecolor="white", markersize=8, clip_on=False, zorder=5)
                ax.set(xticks=[], yticks=[])
                ax.grid(False)
                ax.spines[:].set_visible(False)
            row[0].set_ylabel(name, fontsize=8)
            ax.figure.colorbar(image, ax=row[-1], extend="max" if top > 1 else "neither")
        for ax, corner in zip(axes[0], CORNERS, strict=True):
            ax.set_title(corner)


def _claim(n: dict[str, Any]) -> Claim:
    stay, own, ruled = n["change_of_those_that_stay"], n["share_above_0.9"], n["share_ruled"]
    changed = verdicts.together(
        verdicts.above(0.1, stay["neural"]),
        verdicts.more("the share of the square where one control point has over 0.9", own["neural"], own["classic"]),
    )
    return Claim(
        paper="In 2D too, moving one control point changes the weights of all to fit the new configuration.",
        measure="The largest change of a weight of a control point that stays, after the softmax; and the share of the "
        "square where one control point has over 0.9 of all weight.",
        measured=f"Change: neural {span(stay['neural'])}, classic {stay['classic_raw']:g} raw and "
        f"{stay['classic_normalised']:.2f} normalised. Over 0.9 on {span(own['neural'], '{:.0%}')}, classic "
        f"{own['classic']:.0%}. The one that moves rules {span(ruled['before'], '{:.0%}')} of the square before, "
        f"{span(ruled['after'], '{:.0%}')} after.",
        ruling=changed,
        conclusions=Conclusions(
            "Regions re-form as a whole. As on the line, normalised classic weights change as well; what they lack "
            "is a region of their own.",
            "Weights change, but not with every seed, or without regions of their own.",
            "The weights do not fit themselves to the new configuration.",
        ),
    )
