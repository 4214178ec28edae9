"""Figure 5: what classic and neural weights do to the flat sides and straight edges of a manufactured shape."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from neuralmls.figures.palette import CLAY, heat
from neuralmls_research.experiments import methods
from neuralmls_research.experiments.reproduce import verdicts
from neuralmls_research.experiments.reproduce.drawing import add_bar, draw_shapes
from neuralmls_research.experiments.reproduce.lab import Lab, classic_title
from neuralmls_research.experiments.reproduce.outcomes import SEED, STEPS, by_methods, group
from neuralmls_research.experiments.reproduce.report import Claim, Conclusions, Picture, Report, Table
from neuralmls_research.experiments.reproduce.subjects import plain_chair
from neuralmls_research.experiments.reproduce.words import span
from neuralmls_research.metrics.triangles import normals

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

SHARP = 30.0  # degrees between the faces at an edge that counts as sharp
FLAT = 1.0  # and at one that counts as none
LONGEST = 0.05  # as finely is the chair cut
SHOWN = 6.0  # degrees at which the colour of a bent place is darkest


def run(lab: Lab) -> Report:
    """Deform the chair by both, and measure what bends that was flat, and how much sharp edges open or close."""
    subject = plain_chair(lab)
    x, faces = subject.positions, single(subject.positions, subject.faces)
    rivals = {classic_title(alpha): methods.classic(alpha=alpha) for alpha in (0.5, 1.0)}
    choice = {
        f"neural{SEED}{seed}": methods.neural(steps=STEPS, width=lab.width, seed=seed) for seed in lab.seeds
    } | rivals
    found, _ = by_methods(subject, choice)
    pairs, corners = neighbours(faces)
    before = angles(x, faces, pairs)
    flat, sharp = before < FLAT, before > SHARP
    measured: dict[str, dict[str, list[float]]] = {}
    shown, colours = {}, [np.broadcast_to(CLAY, x.shape)]
    for label, outcomes in group(found).items():
        changes = [np.abs(angles(outcome.positions, faces, pairs) - before) for outcome in outcomes]
        measured[label] = {
            "flat_edges_bent_share": [float((change[flat] > FLAT).mean()) for change in changes],
            "flat_mean_degrees": [float(change[flat].mean()) for change in changes],
            "sharp_mean_degrees": [float(change[sharp].mean()) for change in changes],
        }
        bent = np.zeros(len(x))
        np.maximum.at(bent, corners[flat], changes[0][flat][:, None])
        colours.append(heat(np.minimum(bent / SHOWN, 1.0)))
        shown[label] = outcomes[0].positions
    file = "fig5-sharp-edges.png"
    draw_shapes(lab, file, subject, shown, len(shown) + 1, colours=colours)
    add_bar(lab, file, SHOWN, "degrees by which two neighbouring triangles of a flat side are bent")
    return Report(
        f"{subject.label}; network of width {lab.width}, {STEPS} steps, T = 1, {len(lab.seeds)} seeds, of which the "
        "first is drawn; rigid.",
        pictures=[
            Picture(
                file,
                "The colour of a vertex is the largest angle, in degrees, between two neighbouring triangles at it "
                f"that were coplanar before: grey is 0°, still flat; the darkest red is {SHOWN:g}° or more. Edges are "
                f"at most {LONGEST:g} of half of the longest side, so that {SHOWN:g}° from one triangle to the next is "
                f"a bend of radius {LONGEST / np.radians(SHOWN):.1f} or tighter: the angle over the edge is the "
                "curvature. Angles that were not flat before, as at sharp edges, are not coloured; the table has them.",
            )
        ],
        tables=[_table(measured)],
        claims=[_claim(measured)],
        numbers=measured,
        missing=subject.missing,
    )


def _table(measured: dict[str, dict[str, list[float]]]) -> Table:
    forms = {"flat_edges_bent_share": "{:.0%}", "flat_mean_degrees": "{:.2f}°", "sharp_mean_degrees": "{:.2f}°"}
    head = ["method", f"flat pairs bent by over {FLAT:g}°", "mean bend of flat pairs", "mean change at sharp edges"]
    rows = [[label, *(span(n[name], form) for name, form in forms.items())] for label, n in measured.items()]
    caption = f"Angles between neighbouring triangles: flat below {FLAT:g}° before, sharp above {SHARP:g}°."
    return Table("fig5-angles", caption, head, rows)


def _claim(measured: dict[str, dict[str, list[float]]]) -> Claim:
    neural, flat, sharp = measured["neural"], "flat_mean_degrees", "sharp_mean_degrees"
    rivals = {label: n for label, n in measured.items() if label != "neural"}
    bend, edge = "the mean bend of flat sides", "the mean change at sharp edges"
    flatter = verdicts.together(
        *(verdicts.less(bend, neural[flat], n[flat][0], name, factor=2) for name, n in rivals.items()),
        *(verdicts.less(edge, neural[sharp], n[sharp][0], name) for name, n in rivals.items()),
    )
    said = "; ".join(
        f"{label} {span(n[flat], '{:.2f}')}° and {span(n[sharp], '{:.2f}')}°" for label, n in measured.items()
    )
    return Claim(
        paper="Neural weights keep flat sides flat and sharp edges straight where classic ones bend them.",
        measure="The mean bend between triangles that were coplanar, and the mean change of the angle at sharp edges.",
        measured=f"{said}.",
        ruling=flatter,
        conclusions=Conclusions(
            "On this chair flat sides stay flatter than with either exponent that the published scripts use.",
            "On this chair flat sides or sharp edges stay better than with one exponent, not clearly with both.",
            "On this chair flat sides and sharp edges stay no better than with classic weights.",
        ),
    )


def single(x: Array, faces: Indices) -> Indices:
    """The triangles without doubles, corners in one place made one: a soup's two-sided sheets have one side left."""
    _, first, index = np.unique(x.round(9), axis=0, return_index=True, return_inverse=True)
    joined = np.sort(first[index.reshape(-1)[faces]], axis=1)
    kept = (joined[:, 0] != joined[:, 1]) & (joined[:, 1] != joined[:, 2])
    return np.unique(joined[kept], axis=0)


def neighbours(faces: Indices) -> tuple[Indices, Indices]:
    """Pairs of triangles that share an edge, (k, 2), and that edge's ends, (k, 2).

    Edges of more or fewer than two triangles are left out.

    Examples
    --------
    >>> [array.tolist() for array in neighbours(np.array([[0, 1, 2], [2, 1, 3]]))]
    [[[0, 1]], [[1, 2]]]
    """
    ends = np.sort(np.stack([faces, np.roll(faces, -1, axis=1)], axis=-1).reshape(-1, 2), axis=1)
    owner = np.repeat(np.arange(len(faces)), 3)
    unique, index, counts = np.unique(ends, axis=0, return_inverse=True, return_counts=True)
    order = np.argsort(index.reshape(-1), kind="stable")
    first = np.cumsum(counts) - counts
    two = counts == 2
    return np.stack([owner[order[first[two]]], owner[order[first[two] + 1]]], axis=1), unique[two]


def angles(x: Array, faces: Indices, pairs: Indices) -> Array:
    """The angle between the planes of each pair of triangles, (k,), 0 to 90 degrees: soups have no outside."""
    n = normals(x, faces)
    n = n / np.maximum(np.linalg.norm(n, axis=1, keepdims=True), 1e-300)
    a, b = n[pairs[:, 0]], n[pairs[:, 1]]
    sine, cosine = np.linalg.norm(np.cross(a, b), axis=1), np.abs((a * b).sum(axis=1))
    found: Array = np.degrees(np.arctan2(sine, cosine))
    return found
