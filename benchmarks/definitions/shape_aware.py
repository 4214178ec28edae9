"""Weights that know the shape: the time of a fit; what they do to chairs and airplanes beside the paper's weights."""

from __future__ import annotations

from itertools import islice
from statistics import median

import numpy as np

import neuralmls as nm
from benchmarks.definitions.exact import DATA
from benchmarks.definitions.million import mesh
from benchmarks.inputs import SEED
from benchmarks.measure import Contender, interleaved
from benchmarks.row import Outcome, Row, check
from benchmarks.setting import Setting
from neuralmls_research.metrics import Measures, measure
from studies.exact_handles import Case, cases

SECONDS = 0.5
SOUP_SECONDS = 0.25
SHARED = 0.1  # what others may have at a control point's own place
WORSE = 1.0  # times the paper's weights, in the median of the cases


def run(setting: Setting) -> Outcome:
    """One fit serves every drag; true poses are measured by `neuralmls benchmark poses`."""
    x, faces = mesh(setting.size(50_000))
    p = nm.farthest_points(x, faces, 12)
    weights = nm.ShapeAwareWeights.fit(p, x, faces, seed=SEED)
    others = 1 - float(np.diagonal(nm.softmax(weights.logits(p))).min())
    checked = [check("what others have at a control point", others, SHARED)]
    ours = Contender("ours", lambda _: nm.ShapeAwareWeights.fit(p, x, faces, seed=SEED))
    seconds = interleaved([ours], setting.rounds)["ours"]
    rows = [Row(f"fit, {len(x):,} vertices, 12 control points", seconds, bar=setting.bar(SECONDS))]
    if not DATA.is_dir():
        said = "the paper's shapes are not there ($NEURALMLS_DATA): the weights are not held against the paper's"
        return Outcome("shape-aware weights", rows, [*checked, said], [])
    folder = DATA / "cases" / "shape-aware-legs"
    soup, at = nm.read(folder / "model.obj"), nm.Session.read(folder / "points.json").points.sources
    ours = Contender("ours", lambda _: nm.ShapeAwareWeights.fit(at, soup.positions, soup.faces, seed=SEED))
    seconds = interleaved([ours], setting.rounds)["ours"]
    name = f"fit, a soup of {len(soup.positions):,} vertices, 12 control points"
    rows.append(Row(name, seconds, bar=setting.bar(SOUP_SECONDS)))
    found = [ratios(case) for case in islice(cases(DATA), 1 if setting.quick else None)]
    for what in found[0]:
        ratio = median(case[what] for case in found)
        rows.append(Row(f"{what} / the paper's weights", ratio, bar=setting.bar(WORSE), unit=""))
    return Outcome("shape-aware weights", rows, checked, [])


def ratios(case: Case) -> dict[str, float]:
    """What exact handles with these weights change, over what the paper's weights (48 steps, soft) change."""
    shape = case.shape
    theirs = measured(case, nm.NeuralWeights.fit(case.p, bounds=shape.bounds, steps=48), 0.0)
    ours = measured(case, nm.ShapeAwareWeights.fit(case.p, shape.positions, shape.faces, seed=SEED), 1.0)
    return {what: value / theirs[what] for what, value in ours.items()}


def measured(case: Case, weights: nm.NeuralWeights | nm.ShapeAwareWeights, adherence: float) -> dict[str, float]:
    """The paper's distortions, over the shape in the mean, and in the median."""
    y = nm.Deformer(case.shape.positions, weights).deform(case.q, adherence=adherence)
    found: Measures = measure(case.shape.positions, y, case.shape.faces, case.p, case.q)
    return {
        "curvature, median": found.curvature.median,
        "curvature, mean": found.curvature.mean,
        "Laplacian, median": found.laplacian.median,
        "Laplacian, mean": found.laplacian.mean,
        "Dirichlet energy, median": found.strain.dirichlet_median,
        "Dirichlet energy, mean": found.strain.dirichlet_mean,
    }
