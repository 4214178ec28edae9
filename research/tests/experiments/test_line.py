"""The paper's line against closed forms, and what is written beside pictures."""

import numpy as np
import pytest

pytest.importorskip("matplotlib", reason="the extra 'figures' is not installed")

from neuralmls_research.experiments.reproduce import line, provenance
from neuralmls_research.experiments.reproduce.deformation_1d import OFFSETS, down, moved
from neuralmls_research.experiments.reproduce.formats import as_latex, latex
from neuralmls_research.experiments.reproduce.line import AFTER, BEFORE, X
from neuralmls_research.experiments.reproduce.report import Table

D = np.abs(X - BEFORE.T)
RAW = 1 / (D + line.EPSILON)  # as the published script has it on the line


def test_raw_classic_weights_on_the_line_are_one_over_the_distance():
    assert line.raw_on_line(line.classic(BEFORE)) == pytest.approx(RAW, rel=2e-6)
    squared = line.raw_on_line(line.classic(BEFORE, alpha=1.0))
    assert squared == pytest.approx(1 / (D**2 + line.EPSILON), rel=2e-6)


def test_normalised_ones_are_the_raw_ones_over_their_sum():
    expected = RAW / RAW.sum(axis=1, keepdims=True)
    assert line.weights_on_line(line.classic(BEFORE)) == pytest.approx(expected, abs=1e-6)


def test_no_raw_classic_weight_changes_when_another_control_point_moves():
    before, after = line.raw_on_line(line.classic(BEFORE)), line.raw_on_line(line.classic(AFTER))
    stay = np.delete(np.arange(len(BEFORE)), line.MOVED)
    assert (before[:, stay] == after[:, stay]).all()
    assert (before[:, line.MOVED] != after[:, line.MOVED]).any()


def test_normalised_classic_weights_change_when_another_control_point_moves():
    before, after = line.weights_on_line(line.classic(BEFORE)), line.weights_on_line(line.classic(AFTER))
    stay = np.delete(np.arange(len(BEFORE)), line.MOVED)
    assert np.abs(before - after)[:, stay].max() > 0.3


def test_the_rigid_displacement_of_a_line_is_the_weighted_mean_of_the_offsets():
    w = RAW / RAW.sum(axis=1, keepdims=True)
    assert moved(X, line.classic(BEFORE), "rigid") == pytest.approx((w @ OFFSETS)[:, 0], abs=1e-4)


def test_the_affine_displacement_of_a_line_is_a_weighted_straight_line():
    w = RAW / RAW.sum(axis=1, keepdims=True)
    p, q = BEFORE[:, 0], (BEFORE + OFFSETS)[:, 0]
    centre, aim = w @ p, w @ q
    a, b = p - centre[:, None], q - aim[:, None]
    slope = (w * a * b).sum(axis=1) / (w * a * a).sum(axis=1)
    expected = slope * (X[:, 0] - centre) + aim - X[:, 0]
    assert moved(X, line.classic(BEFORE), "affine") == pytest.approx(expected, abs=1e-4)


def test_going_down_counts_falls_alone():
    assert down(np.array([0.0, 1.0, 0.25, 2.0, 1.5])) == pytest.approx(1.25)


def test_latex_prints_signs_as_they_are():
    assert latex("50 % of a_b & |Δ| < 2°") == r"50 \% of a\_b \& $|$$\Delta$$|$ $<$ 2$^\circ$"
    table = Table("t", "a caption", ["method", "error"], [["neural", "0.1"], ["classic", "0.2"]])
    assert r"\begin{tabular}{lr}" in as_latex(table)
    assert r"classic & 0.2 \\" in as_latex(table)


def test_a_caption_of_several_lines_stays_a_comment():
    comment = [text for text in as_latex(Table("t", "one\ntwo", ["a"], [["b"]])).splitlines() if "two" in text]
    assert all(text.startswith("%") for text in comment)


def test_code_outside_of_a_checkout_has_a_version_and_no_commit(tmp_path):
    found = provenance.code(tmp_path)
    assert found["commit"] is None
    assert found["changed"] is None
    assert found["version"]
