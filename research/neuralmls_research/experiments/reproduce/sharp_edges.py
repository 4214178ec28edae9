"""Figure 5: what classic and neural weights do to the flat sides and straight edges of a manufactured shape."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from neuralmls.figures.palette import CLAY, heat
from neuralmls_research.experiments import methods
from neuralmls_research.experiments.reproduce import verdicts
from neuralmls_research.experiments.reproduce.drawing import draw_shapes
from neuralmls_research.experiments.reproduce.lab import Lab
from neuralmls_research.experiments.reproduce.outcomes import by_methods
from neuralmls_research.experiments.reproduce.report import Claim, Picture, Report, Table
from neuralmls_research.experiments.reproduce.subjects import plain_chair
from neuralmls_research.metrics.triangles import normals

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

SHARP = 30.0  # degrees between the faces at an edge that counts as sharp
FLAT = 1.0  # and at one that counts as none
SHOWN = 6.0  # degrees at which the colour of a bent place is darkest


def run(lab: Lab) -> Report:
    """Deform the chair by both, and measure what bends that was flat, and how much sharp edges open or close."""
    subject = plain_chair(lab)
    x, faces = subject.positions, single(subject.positions, subject.faces)
    choice = {
        "neural": methods.neural(steps=48, width=lab.width),
        "classic, alpha 0.5": methods.classic(),
        "classic, alpha 1": methods.classic(alpha=1.0),
    }
    found, _ = by_methods(subject, choice)
    pairs, corners = neighbours(faces)
    before = angles(x, faces, pairs)
    flat, sharp = before < FLAT, before > SHARP
    rows, measured, colours = [], {}, [np.broadcast_to(CLAY, x.shape)]
    for outcome in found:
        change = np.abs(angles(outcome.positions, faces, pairs) - before)
        bent = np.zeros(len(x))
        np.maximum.at(bent, corners[flat], change[flat][:, None])
        colours.append(heat(np.minimum(bent / SHOWN, 1.0)))
        share = float((change[flat] > FLAT).mean())
        measured[outcome.label] = {
            "flat_edges_bent_share": share,
            "flat_mean_degrees": float(change[flat].mean()),
            "sharp_mean_degrees": float(change[sharp].mean()),
        }
        rows.append([outcome.label, f"{share:.0%}", f"{change[flat].mean():.2f}°", f"{change[sharp].mean():.2f}°"])
    draw_shapes(
        lab, "fig5-sharp-edges.png", subject, {o.label: o.positions for o in found}, len(found) + 1, colours=colours
    )
    ours, theirs = measured["neural"], measured["classic, alpha 1"]
    flatter = verdicts.less(
        "the neural value", [ours["flat_mean_degrees"]], factor=2, rival=theirs["flat_mean_degrees"]
    )
    return Report(
        f"{subject.label}; classic weights 1/d^(2 alpha); network of width {lab.width}, 48 steps, T = 1; rigid.",
        pictures=[
            Picture(
                "fig5-sharp-edges.png",
                f"Coloured where what was flat is bent: grey is flat, the darkest red {SHOWN:g}° or more from one "
                "triangle to the next. Classic weights bow the seat, the back and their edges; with neural ones they "
                "stay flat and straight, and what bends lies between the control points.",
            )
        ],
        tables=[
            Table(
                "fig5-angles",
                "Angles between neighbouring triangles.",
                [
                    "method",
                    f"flat pairs bent by over {FLAT:g}°",
                    "mean bend of flat pairs",
                    "mean change at sharp edges",
                ],
                rows,
            )
        ],
        claims=[
            Claim(
                paper="Neural weights keep flat sides flat and sharp edges straight where classic ones bend them.",
                measure="The mean bend between triangles that were coplanar.",
                rule=flatter.rule,
                measured=f"Pairs of coplanar triangles bent by more than {FLAT:g}°: neural "
                f"{ours['flat_edges_bent_share']:.0%}, "
                f"classic {theirs['flat_edges_bent_share']:.0%}; mean bend {ours['flat_mean_degrees']:.2f}° and "
                f"{theirs['flat_mean_degrees']:.2f}°; mean change of the angle at sharp edges "
                f"{ours['sharp_mean_degrees']:.2f}° and {theirs['sharp_mean_degrees']:.2f}°.",
                verdict=flatter.verdict,
                reader="Flat sides stay flatter.",
            )
        ],
        numbers=measured,
        missing=subject.missing,
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
