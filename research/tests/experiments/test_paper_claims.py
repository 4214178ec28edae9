"""What the reports say of the paper's claims, with made-up numbers that agree, agree in part, and contradict."""

import numpy as np
import pytest

pytest.importorskip("pyvista", reason="the extra 'figures' is not installed")
pytest.importorskip("matplotlib", reason="the extra 'figures' is not installed")
pytest.importorskip("igl", reason="the extra 'baselines' is not installed")

from neuralmls_research.experiments.reproduce import alpha, armadillo, armadillo_grid, scatter, subjects
from neuralmls_research.experiments.reproduce.armadillo_grid import Setting
from neuralmls_research.experiments.reproduce.classic_sweep import Sweep
from neuralmls_research.experiments.reproduce.lab import Lab
from neuralmls_research.experiments.reproduce.outcomes import CLASSIC_LABEL, KPD_LABEL, NEURAL_LABEL, Outcome, table
from neuralmls_research.experiments.reproduce.report import Report
from neuralmls_research.experiments.reproduce.scatter_cases import Case, wins
from neuralmls_research.experiments.reproduce.verdicts import Verdict

REPRODUCED, PARTLY, CONTRADICTED = Verdict.REPRODUCED, Verdict.PARTLY, Verdict.CONTRADICTED


def case(neural: list[float], classic: float, kpd: float, category: str = "airplane") -> Case:
    """A deformation with the same numbers on both axes."""
    values = {NEURAL_LABEL: neural, CLASSIC_LABEL: [classic], KPD_LABEL: [kpd]}
    return Case(category, "made up", dict.fromkeys(("laplacian", "error", "curvature"), values))


@pytest.mark.parametrize(
    ("cases", "verdict", "told"),
    [
        ([case([1.0, 1.2], 2.0, 3.0)] * 3, REPRODUCED, "3 of 3"),
        ([case([1.0, 2.2], 2.0, 3.0)] * 3, PARTLY, "0 of 3"),  # a seed is worse than classic weights
        ([case([4.0, 5.0], 2.0, 3.0)] * 6, CONTRADICTED, "0 of 6"),
        ([case([1.0, 1.2], 2.0, 3.0)] * 2, Verdict.UNTESTABLE, "2 of 2"),  # too few deformations
    ],
)
def test_a_category_of_figure_6_is_told_plainly(cases, verdict, told):
    claim = scatter._distortion("airplane", cases)
    assert claim.verdict == verdict
    assert f"{CLASSIC_LABEL} in {told}" in claim.measured
    assert "Laplacian" in claim.measure


def test_a_category_without_a_shape_has_no_numbers():
    claim = scatter._distortion("airplane", [])
    assert claim.verdict == Verdict.UNTESTABLE
    assert claim.measured == "Nothing: no such shape is here."


def test_better_on_both_axes_is_told_from_a_trade():
    trade = Case("chair", "", {"laplacian": {NEURAL_LABEL: [3.0], CLASSIC_LABEL: [2.0]},
                               "error": {NEURAL_LABEL: [0.1], CLASSIC_LABEL: [0.2]}})  # fmt: skip
    assert not trade.dominated()
    assert not trade.better_on_both(CLASSIC_LABEL)
    assert case([4.0], 2.0, 9.0).dominated()
    assert case([1.0], 2.0, 9.0).better_on_both(CLASSIC_LABEL)
    assert wins([case([1.0], 2.0, 9.0), trade], "error", KPD_LABEL) == "1 of 1"  # where it applies


def setting(neural: float, width: int = 1024, measure: str = "mean curvature") -> Setting:
    inputs = ("1k vertices", "ours, twelve", "all limbs", 1.0, 48, width, 1.0, "rigid", measure)
    return Setting(*inputs, neural=neural, classic=0.578, arap=0.574, behind=0.1)


@pytest.mark.parametrize(
    ("settings", "verdict"),
    [
        ([setting(0.412), setting(0.9)], REPRODUCED),
        ([setting(0.412), setting(0.9), setting(1.0)], PARTLY),
        ([setting(0.576), setting(0.9)], CONTRADICTED),  # between the others is not first
    ],
)
def test_the_armadillos_order_is_counted_over_the_grid(settings, verdict):
    assert armadillo._of_grid(settings).verdict == verdict


def test_the_armadillo_with_the_papers_width_leaves_other_widths_out():
    claim = armadillo._as_printed([setting(0.9), setting(0.4, width=128)], 1024, "")
    assert claim.verdict == CONTRADICTED
    assert "0 of 1" in claim.measured
    rows = {row[0]: row[2] for row in armadillo._shares([setting(0.9), setting(0.4, width=128)]).rows}
    assert (rows["width: 128"], rows["width: 1024"]) == ("100%", "0%")


def test_the_grid_runs_through_inputs_and_settings(tmp_path, data, monkeypatch):
    for name, values in (("STEPS", (48,)), ("SIZES", (1.0,)), ("MESHES", {"small": 300}), ("TRANSFORMS", ("rigid",))):
        monkeypatch.setattr(armadillo_grid, name, values)
    settings = armadillo_grid.grid(Lab(tmp_path, data, quick=True))
    # 3 sets of control points, 2 motions, 2 widths, 3 temperatures, 3 measures, less the inputs that ARAP refuses.
    assert 0 < len(settings) <= 108
    assert len(settings) % 18 == 0
    assert {found.measure for found in settings} == set(armadillo_grid.MEASURES)
    assert all(np.isfinite([found.neural, found.classic, found.arap, found.behind]).all() for found in settings)


def test_without_the_armadillo_its_order_has_no_verdict(tmp_path):
    report = Report("")
    armadillo.of_armadillo(Lab(tmp_path), report)
    assert [claim.verdict for claim in report.claims] == [Verdict.UNTESTABLE]
    assert any("$NEURALMLS_DATA" in sentence for sentence in report.missing)


def outcome(label: str, value: float) -> Outcome:
    return Outcome(label, np.zeros((1, 3)), dict.fromkeys(alpha.SHOWN, value) | {"dirichlet": 4.0 + value})


@pytest.mark.parametrize(("best", "verdict"), [(1.4, CONTRADICTED), (1.6, REPRODUCED)])
def test_one_good_alpha_contradicts_that_there_is_none(best, verdict):
    classic = {1.0: outcome("1", 9.0), 2.0: outcome("2", best)}
    neural = [outcome("neural, seed 0", 0.9), outcome("neural, seed 1", 1.1)]
    claim = alpha._none(Sweep(classic, neural, Report("")))
    assert claim.verdict == verdict
    assert ("alpha 2 every" in claim.measured) == (verdict == CONTRADICTED)


def test_a_table_gives_the_range_of_the_seeds():
    shown = table("t", "", "method", [outcome("neural, seed 0", 1.0), outcome("neural, seed 1", 2.0)], ["error"])
    assert shown.rows == [["neural", "1.0000 to 2.0000"]]


def test_cars_have_keypoints_where_the_weights_are(tmp_path, golden):
    found = subjects.cars(Lab(tmp_path, golden=golden))
    assert [len(subject.points) for subject in found] == [8, 8, 8]
    assert all(subject.differs_by_displacement(found[0]) for subject in found)
    moved = [np.linalg.norm(subject.points.targets - subject.points.sources, axis=1) > 0 for subject in found]
    assert [int(some.sum()) for some in moved] == [4, 2, 4]
    assert len(subjects.cars(Lab(tmp_path))) == 1
