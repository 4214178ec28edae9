"""Exact handles on the user study's cases: they arrive, and the study of them compares what it says."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import neuralmls as nm
from neuralmls.plugin import Transform
from neuralmls_research.experiments.published import published
from studies.exact_handles import PAPER, TRAININGS, cases, compared, summary

CASES = ["ShapeNetChair1", "ShapeNetChair3", "ShapeNetPlane1", "ShapeNetPlane2"]


@pytest.mark.parametrize("transform", ["rigid", "similarity", "affine"])
@pytest.mark.parametrize("name", CASES)
def test_the_handles_of_the_user_study_arrive(data: Path, name: str, transform: Transform) -> None:
    case = published(data, name)
    assert case is not None
    p, side = case.displacements["default"].sources, np.ptp(case.shape.bounds, axis=0).max()
    weights = nm.NeuralWeights.fit(p, bounds=case.shape.bounds, steps=48)
    handles, exact = nm.Deformer(p, weights, transform=transform), nm.ExactHandles(weights, transform=transform)
    for q in (points.targets for points in case.displacements.values()):
        aim = exact.aim(q)
        assert np.abs(handles.deform(q, adherence=1.0) - q).max() < 1e-6 * side
        assert aim.misses.max() < 1e-6 * side
        np.testing.assert_array_equal(handles.deform(aim.targets), handles.deform(q, adherence=1.0))


def test_the_study_compares_soft_and_exact_handles(data: Path, capsys: pytest.CaptureFixture[str]) -> None:
    case = next(case for case in cases(data) if case.title == "ShapeNetChair3, user_study_2")
    soft, exact = compared(case, TRAININGS[PAPER])
    assert exact.error < 1e-8 < 1e-3 < soft.error < 0.01
    assert exact.curvature < 1.1 * soft.curvature
    assert capsys.readouterr().out.startswith("| ShapeNetChair3, user_study_2 | 0.9")
    assert "1.000 in the median (1.000 to 1.000)" in summary([(soft, soft)])
