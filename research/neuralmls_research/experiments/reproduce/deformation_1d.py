"""Figure 7: what neural and classic weights make of the same displacements of six control points on a line."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from neuralmls import Deformer, NeuralWeights, Weights
from neuralmls.plugin import Transform
from neuralmls_research.experiments.reproduce import line, verdicts
from neuralmls_research.experiments.reproduce.drawing import CLASSIC, NEURAL, draw_weights, plots
from neuralmls_research.experiments.reproduce.lab import Lab, classic_title
from neuralmls_research.experiments.reproduce.line import BEFORE, TEMPERATURES, X, weights_on_line
from neuralmls_research.experiments.reproduce.report import Claim, Conclusions, Picture, Report
from neuralmls_research.experiments.reproduce.words import span

Array = NDArray[np.float64]

# As in the published script: displacements from -5 to 5, two of them none; affine, where its other scripts are rigid.
OFFSETS = np.array([[-5.0], [-2.5], [0.0], [0.0], [2.5], [5.0]])
TRANSFORMS: dict[str, Transform] = {"affine": "affine", "rigid": "rigid"}
CUT = 4.0  # where the published script cuts the axis of raw weights
STRAIGHT = 0.1  # a curve is straight where its slope changes by less than this a unit


def run(lab: Lab) -> Report:
    """Draw both deformations with their weights, and measure how much they go up and down."""
    networks, classic = line.networks(lab, BEFORE), line.classic(BEFORE)
    _draw(lab, networks[0], classic)
    _draw_temperatures(lab, networks[0])
    numbers: dict[str, Any] = {"goes_down_by": {}, "straight_share": {}, "worst_control_point_error": {}}
    for name, transform in TRANSFORMS.items():
        curves = {
            "neural": [moved(X, function, transform) for function in networks],
            "classic_1/d": [moved(X, classic, transform)],
            "classic_1/d^2": [moved(X, line.classic(BEFORE, 1.0), transform)],
        }
        numbers["goes_down_by"][name] = {kind: [down(u) for u in found] for kind, found in curves.items()}
        numbers["straight_share"][name] = {kind: [straight(u) for u in found] for kind, found in curves.items()}
        numbers["worst_control_point_error"][name] = {
            "neural": [_missed(function, transform) for function in networks],
            "classic_1/d": [_missed(classic, transform)],
        }
    return Report(
        line.SETTING.format(width=lab.width, seeds=len(lab.seeds))
        + " Affine, as in the published script; rigid, which on a line is a shift, beside it.",
        pictures=[
            Picture(
                "fig7-deformation.png",
                "Above, how far each place of the line moves; dots are the displacements asked for, broken lines the "
                "rigid transform. Neural weights give straight pieces (rigid: steps) with soft transitions; classic "
                "ones bend between the dots and have kinks at them (rigid: they turn back). In the middle the slopes. "
                "Below, the weights that make the curves, classic ones raw as the paper draws them.",
            ),
            Picture(
                "fig7-temperature.png",
                "The same network at three temperatures: the displacement, and its slope. A low temperature goes "
                "through the dots, a high one passes them by.",
            ),
        ],
        claims=_claims(numbers),
        numbers=numbers,
    )


def moved(x: Array, function: Weights, transform: Transform, temperature: float = 1.0) -> Array:
    """How far each of x (n, 1) moves, (n,)."""
    found = Deformer(x, function, transform=transform).deform(BEFORE + OFFSETS, temperature)
    return (np.asarray(found, dtype=np.float64) - x)[:, 0]


def down(curve: Array) -> float:
    """What a curve (n,) goes down by in all: the displacements asked for only rise, so it made that up.

    Examples
    --------
    >>> down(np.array([0.0, 2.0, 1.5, 3.0]))
    0.5
    """
    return float(np.maximum(-np.diff(curve), 0).sum())


def straight(curve: Array) -> float:
    """The share of the line where a curve over it, (n,), is straight."""
    return float((np.abs(line.slopes(line.slopes(curve))) < STRAIGHT).mean())


def _missed(function: Weights, transform: Transform) -> float:
    return float(np.abs(moved(BEFORE, function, transform) - OFFSETS[:, 0]).max())


def _draw(lab: Lab, network: NeuralWeights, classic: Weights) -> None:
    title = classic_title(line.ALPHA)
    columns = (
        ("neural, T = 1", network, NEURAL, weights_on_line(network), 1.05),
        (title, classic, CLASSIC, line.raw_on_line(line.classic(BEFORE)), CUT),
    )
    with plots(lab, "fig7-deformation.png", 3, 2, (11, 8), sharex=True) as axes:
        axes[0, 1].sharey(axes[0, 0])
        axes[1, 1].sharey(axes[1, 0])
        for column, (name, function, colour, w, top) in zip(axes.T, columns, strict=True):
            _displacements(column[:2], function, colour)
            column[0].set_title(name)
            draw_weights(column[2], X, w, BEFORE, "" if top < CUT else "raw", top)
            column[2].set(xlabel="x", ylabel="weight")
        axes[0, 0].legend()


def _draw_temperatures(lab: Lab, network: NeuralWeights) -> None:
    with plots(lab, "fig7-temperature.png", 2, len(TEMPERATURES), (14, 5.4), sharex=True, sharey="row") as axes:
        for column, value in zip(axes.T, TEMPERATURES, strict=True):
            _displacements(column, network, NEURAL, value)
            column[0].set_title(f"neural, T = {value:g}")
            column[1].set_xlabel("x")
            column[0].label_outer()
            column[1].label_outer()
        axes[0, 0].legend()


def _displacements(rows: Any, function: Weights, colour: str, temperature: float = 1.0) -> None:
    """Draw the displacement and its slope, affine and rigid."""
    for transform, style in ((TRANSFORMS["affine"], "-"), (TRANSFORMS["rigid"], "--")):
        u = moved(X, function, transform, temperature)
        look: dict[str, Any] = {"color": colour, "linestyle": style, "linewidth": 1.8 if style == "-" else 1.0}
        rows[0].plot(X[:, 0], u, label=transform, **look)
        rows[1].plot(X[:, 0], line.slopes(u), **look)
    rows[0].plot(BEFORE[:, 0], OFFSETS[:, 0], "o", color="#222222", markersize=5)
    rows[0].set_ylabel("displacement")
    rows[1].set_ylabel("its slope")
    rows[1].set_yscale("symlog", linthresh=2)


def _claims(n: dict[str, Any]) -> list[Claim]:
    affine, shift = n["goes_down_by"]["affine"], n["goes_down_by"]["rigid"]
    pieces, error = n["straight_share"]["affine"], n["worst_control_point_error"]
    rival = affine["classic_1/d"][0]
    waver = verdicts.less("what the neural curve goes down by", affine["neural"], rival, factor=10)
    smooth = verdicts.more(
        "the share of the line where the curve is straight", pieces["neural"], pieces["classic_1/d"][0]
    )
    close = verdicts.below(0.05, error["affine"]["neural"])
    return [
        Claim(
            paper="Between displacements that only rise, classic weights waver; neural ones do not.",
            measure="What a curve goes down by in all, of the 10 that it is asked to rise by: affine, 1/d.",
            measured=f"Affine: neural {span(affine['neural'])}, classic {rival:.2f} (1/d²: "
            f"{affine['classic_1/d^2'][0]:.2f}). Rigid: neural {span(shift['neural'], '{:.1g}')}, classic "
            f"{shift['classic_1/d'][0]:.2f} (1/d²: {shift['classic_1/d^2'][0]:.2f}).",
            ruling=waver,
            conclusions=Conclusions(
                "Classic weights waver at least ten times as much.",
                "Neural weights waver less, but not by a factor of ten: in an affine piece they overshoot a little "
                "where two control points stay. With the rigid transform, by which the shapes are deformed, the "
                "contrast is much larger.",
                "Neural weights waver as much as classic ones.",
            ),
        ),
        Claim(
            paper="Neural weights give a piecewise smooth deformation.",
            measure=f"The share of the line where the displacement is straight: its slope changes by less than "
            f"{STRAIGHT:g} a unit. Affine.",
            measured=f"Neural {span(pieces['neural'], '{:.0%}')}, classic {pieces['classic_1/d'][0]:.0%} (1/d²: "
            f"{pieces['classic_1/d^2'][0]:.0%}).",
            ruling=smooth,
            conclusions=Conclusions(
                "Each pair of neighbours owns a straight piece; pieces join in short soft bends.",
                "It depends on the seed.",
                "Neural weights leave less of the line straight than classic ones.",
            ),
        ),
        Claim(
            paper="The control points are approximated closely, though nothing forces an interpolation.",
            measure="The worst distance from a displacement asked for, of 10.",
            measured=f"Affine: neural {span(error['affine']['neural'], '{:.1g}')}, classic "
            f"{error['affine']['classic_1/d'][0]:.1g}. Rigid: neural {span(error['rigid']['neural'], '{:.1g}')}.",
            ruling=close,
            conclusions=Conclusions(
                "The training has taught the network where its control points are.",
                "It depends on the seed whether the training was long enough.",
                "The training was too short: control points stay behind.",
            ),
        ),
    ]
