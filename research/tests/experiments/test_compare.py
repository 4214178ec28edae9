"""Methods side by side: one way to call them, and words where one does not apply."""

from __future__ import annotations

import numpy as np
import pytest

import neuralmls as nm
from neuralmls_research import baselines
from neuralmls_research.experiments.compare import attempt
from neuralmls_research.experiments.methods import METHODS, Surface, classic, kpd, neural, of_shapes, with_settings
from neuralmls_research.metrics import folded_places

OF_SURFACES = ("arap", "arap-from-fit", "biharmonic", "biharmonic-displacements")


@pytest.fixture
def sheet() -> Surface:
    """A square of 10 x 10 squares, bent a little: connected, manifold, every triangle with area."""
    u, v = (axis.ravel() for axis in np.meshgrid(np.linspace(-1, 1, 11), np.linspace(-1, 1, 11)))
    corner = (np.arange(10)[:, None] * 11 + np.arange(10)).ravel()
    faces = [[corner, corner + 1, corner + 12], [corner, corner + 12, corner + 11]]
    return Surface(np.stack([u, v, 0.1 * u * v], axis=1), np.concatenate([np.stack(face, axis=1) for face in faces]))


@pytest.fixture
def moved(sheet: Surface) -> tuple[np.ndarray, np.ndarray]:
    """Its corners and middle, one corner lifted."""
    p = sheet.positions[[0, 10, 60, 110, 120]]
    q = p.copy()
    q[0, 2] += 0.3
    return p, q


@pytest.mark.parametrize("name", METHODS)
def test_every_method_moves_its_control_points(name, sheet, moved):
    if name in OF_SURFACES:
        pytest.importorskip("igl")
    result = attempt(METHODS[name], sheet, *moved)
    assert result.reason is None
    assert result.positions.shape == sheet.positions.shape
    assert result.measures.at_vertices < 0.03
    assert (result.measures.at_points is None) == (METHODS[name].bind(sheet, moved[0]).space is None)
    assert np.array_equal(METHODS[name](sheet, moved[0], moved[0]), sheet.positions)


@pytest.mark.parametrize("name", [name for name in METHODS if name not in OF_SURFACES])
def test_the_map_of_space_gives_the_positions_at_the_vertices(name, sheet, moved):
    bound = METHODS[name].bind(sheet, moved[0])
    f = bound.space(moved[1])
    np.testing.assert_allclose(f(sheet.positions), bound.positions(moved[1]), atol=1e-9)
    np.testing.assert_allclose(f(sheet.positions[:7]), f(sheet.positions)[:7], atol=1e-5)
    assert folded_places(f, sheet.positions, step=1e-3) == 0


def test_options_reach_the_weights(sheet, moved):
    p, q = moved
    expected = nm.Deformer(sheet.positions, nm.InverseDistanceWeights(p, alpha=2.0), transform="affine").deform(q)
    np.testing.assert_allclose(classic(alpha=2.0, transform="affine")(sheet, p, q), expected)
    assert not np.allclose(classic()(sheet, p, q), classic(alpha=1.0)(sheet, p, q))
    bounds = np.stack([sheet.positions.min(axis=0), sheet.positions.max(axis=0)])
    weights = nm.NeuralWeights.fit(p, bounds=bounds, steps=5, seed=3, width=64)
    expected = nm.Deformer(sheet.positions, weights).deform(q, 0.5)
    assert np.array_equal(neural(steps=5, seed=3, width=64, temperature=0.5)(sheet, p, q), expected)


def test_a_title_has_what_is_not_at_its_default_and_alpha_always():
    titles = {name: method.title for name, method in METHODS.items()}
    assert titles["neural"] == "NeuralMLS"
    assert titles["neural-exact"] == "NeuralMLS, exact (ours)"
    assert titles["classic"] == "Classic MLS (alpha 0.5: 1/d)"
    assert classic(alpha=2.0, temperature=0.5).title == "Classic MLS (alpha 2: 1/d^4, temperature 0.5)"
    assert neural(steps=48, width=128, transform="affine").title == "NeuralMLS (width 128, 48 steps, affine)"


def test_what_a_person_says_goes_to_the_methods_that_have_it():
    changed = with_settings(METHODS, {"alpha": 2.0, "seed": 3, "temperature": 0.5})
    own = {name: method.settings for name, method in changed.items()}
    assert own["classic"]["weights"]["alpha"] == 2.0
    assert own["neural-exact"]["weights"]["seed"] == own["shape-aware"]["weights"]["seed"] == 3
    assert own["neural-exact"]["handles"] == "exact"
    assert {settings["temperature"] for settings in own.values() if settings} == {0.5}
    assert changed["rbf"] is METHODS["rbf"]
    several = with_settings({"neural": neural(steps=200)}, {"seed": 1})["neural"].settings["weights"]
    assert (several["steps"], several["seed"]) == (200, 1)


def test_a_setting_that_no_method_has_or_that_is_out_of_range_is_refused():
    with pytest.raises(nm.ArgumentError, match="alpha: none of the methods neural, rbf has such a setting"):
        with_settings({name: METHODS[name] for name in ("neural", "rbf")}, {"alpha": 2.0})
    with pytest.raises(nm.ArgumentError, match="temperature: expected a number above 0, found -1"):
        with_settings(METHODS, {"temperature": -1.0})


def test_what_does_not_apply_says_why(sheet, moved):
    soup = Surface(sheet.positions[sheet.faces].reshape(-1, 3), np.arange(sheet.faces.size).reshape(-1, 3))
    pytest.importorskip("igl")
    result = attempt(METHODS["arap"], soup, *moved)
    assert (result.positions, result.seconds, result.measures) == (None, None, None)
    assert result.reason.startswith("ARAP needs")
    flat = Surface(sheet.positions[:, :2], None)
    p, q = (points[:, :2] for points in moved)
    assert "in space" in attempt(METHODS["rbf"], flat, p, q + 1).reason
    assert attempt(METHODS["classic"], flat, p, q + 1).measures.strain is None


def test_a_library_that_is_not_there_is_a_reason(sheet, moved, monkeypatch):
    def missing(*_):
        raise nm.NeuralMLSError("this baseline needs igl, which is not installed: pip install neuralmls-research")

    assert "pip install" in attempt(of_shapes("ARAP", missing), sheet, *moved).reason


@pytest.mark.parametrize("name", ["neural", "classic", "rbf"])
def test_control_points_that_do_not_fit_are_an_error(name, sheet, moved):
    with pytest.raises((nm.ArgumentError, nm.ControlPointError)):
        attempt(METHODS[name], sheet, moved[0], moved[1][:2])


def test_keypoint_deformer_is_a_method_like_the_others(golden):
    pytest.importorskip("igl")
    stored = np.load(golden / "kpd" / "plane2.npz")
    case = stored["case_names"].tolist().index("userstudy0_ref")
    shape = Surface(stored["vertices"].astype(float), stored["faces"])
    method = kpd(golden / "kpd" / "weights" / "kpd_airplane_8kpt.safetensors")
    p = stored["keypoints"].astype(float)
    result = attempt(method, shape, p, p + stored["offsets"][case])
    assert result.title == baselines.TITLES["kpd"]
    assert result.measures.at_points is None
    assert np.isfinite(result.measures.curvature.median)
    far = attempt(method, shape, p + 0.5, p + 1.0)
    assert "keypoints" in far.reason


def test_weights_that_cannot_be_read_are_an_error(tmp_path):
    pytest.importorskip("safetensors")
    with pytest.raises(nm.FileError, match=r"none\.safetensors"):
        kpd(tmp_path / "none.safetensors")
