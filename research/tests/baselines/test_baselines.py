"""Every baseline: the same call, laws that hold for all, and words instead of crashes."""

from __future__ import annotations

import subprocess
import sys
from contextlib import suppress

import numpy as np
import pytest

import neuralmls as nm
from neuralmls.errors import NeuralMLSError, NotApplicable
from neuralmls_research import baselines
from neuralmls_research.baselines import checks
from neuralmls_research.baselines.biharmonic import weights
from research.tests.baselines.conftest import bar

EVERYWHERE = ("classic", "rbf")
ON_MESHES = ("arap", "biharmonic", "biharmonic-displacements")
SURFACE = EVERYWHERE + ON_MESHES
TARGET = np.array([[0, 0, 0], [1, 0, 0], [1.0, 2 / 12, 2 / 12], [0.5, 0, 2 / 12]])


def control_points(q_of=lambda p: p):
    return TARGET, q_of(TARGET)


@pytest.mark.parametrize("name", SURFACE)
def test_unmoved_control_points_return_the_positions_bit_for_bit(name, a_bar):
    y = baselines.get(name)(a_bar, *control_points())
    assert y.dtype == np.float64
    assert np.array_equal(y, a_bar.positions)
    assert y.flags.writeable  # a copy, not the shape's own


@pytest.mark.parametrize("name", SURFACE)
def test_a_translation_of_all_control_points_moves_every_vertex_by_it(name, a_bar):
    step = np.array([0.3, -2.0, 0.7])
    y = baselines.get(name)(a_bar, *control_points(lambda p: p + step))
    np.testing.assert_allclose(y, a_bar.positions + step, atol=1e-6)


@pytest.mark.parametrize("name", SURFACE)
def test_control_points_on_vertices_reach_their_targets(name, a_bar):
    p, q = control_points(lambda p: p + np.array([[0, 0, 0], [0, 0.2, 0], [0, 0.2, 0], [0, 0, 0.1]]))
    y = baselines.get(name)(a_bar, p, q)
    at = [int(np.linalg.norm(a_bar.positions - point, axis=1).argmin()) for point in p]
    np.testing.assert_allclose(y[at], q, atol=1e-6)


@pytest.mark.parametrize("name", SURFACE)
def test_units_and_place_of_the_file_do_not_matter(name, shape):
    vertices, faces = bar()
    p, q = control_points(lambda p: p + np.array([[0, 0, 0], [0, 0.2, 0], [0, 0.2, 0], [0, 0, 0.1]]))
    small = baselines.get(name)(shape(vertices, faces), p, q)
    scale, place = 1000.0, np.array([5e5, -2e5, 3e4])
    large = baselines.get(name)(shape(vertices * scale + place, faces), p * scale + place, q * scale + place)
    np.testing.assert_allclose((large - place) / scale, small, atol=1e-6)


@pytest.mark.parametrize("name", EVERYWHERE)
def test_clouds_are_deformed_where_no_faces_are_needed(name, shape):
    cloud = shape(np.random.default_rng(0).normal(size=(50, 3)))
    y = baselines.get(name)(cloud, *control_points(lambda p: np.add(p, [0, 0, 1])))
    assert np.isfinite(y).all()


@pytest.mark.parametrize("name", ON_MESHES)
class TestWhatSolversForSurfacesRefuse:
    def refused(self, name, shape, *words, p=TARGET, q=None):
        with pytest.raises(NotApplicable) as caught:
            baselines.get(name)(shape, p, np.add(p, [0, 0, 1.0]) if q is None else q)
        for word in words:
            assert word in str(caught.value)
        assert "\n" not in str(caught.value)

    def test_a_cloud(self, name, shape):
        self.refused(name, shape(bar()[0]), "cloud of points")

    def test_a_part_without_a_control_point(self, name, shape):
        vertices, faces = bar()
        two = shape(
            np.concatenate([vertices, np.add(vertices, [0, 5, 0])]), np.concatenate([faces, faces + len(vertices)])
        )
        self.refused(name, two, "1 of 2 have none", f"vertex {len(vertices)}")

    def test_an_edge_on_three_faces(self, name, shape):
        vertices, faces = bar()
        a, b = faces[0][:2]
        fin = shape(np.concatenate([vertices, [[0, 5, 5]]]), np.concatenate([faces, [[a, b, len(vertices)]]]))
        self.refused(name, fin, "manifold", f"from vertex {min(a, b)} to {max(a, b)} on 3")

    def test_parts_that_meet_at_one_vertex(self, name, shape):
        vertices, faces = bar()
        more = np.array([[5.0, 0, 0], [5.0, 1, 0]])
        pinched = shape(
            np.concatenate([vertices, more]), np.concatenate([faces, [[0, len(vertices), len(vertices) + 1]]])
        )
        self.refused(name, pinched, "manifold", "share no edge, first 0")

    def test_a_triangle_without_area(self, name, shape):
        vertices, faces = bar()
        a, b = vertices[faces[0][0]], vertices[faces[0][1]]
        middle = len(vertices)
        flat = np.concatenate([faces, [[faces[0][0], faces[0][1], middle]]])
        self.refused(name, shape(np.concatenate([vertices, [(a + b) / 2]]), flat), "1 have none", f"first {len(faces)}")

    def test_a_triangle_that_names_a_vertex_twice(self, name, shape):
        vertices, faces = bar()
        self.refused(name, shape(vertices, np.concatenate([faces, [[3, 3, 4]]])), "area", f"first {len(faces)}")

    def test_a_vertex_on_no_face(self, name, shape):
        vertices, faces = bar()
        loose = shape(np.concatenate([vertices, [[9.0, 9, 9]]]), faces)
        self.refused(name, loose, "1 are on none", f"first {len(vertices)}")

    def test_two_control_points_with_the_same_nearest_vertex(self, name, a_bar):
        p = np.array([[0, 0, 0], [1, 0, 0], [1.001, 0, 0]])
        self.refused(name, a_bar, "both control points 1 and 2", p=p)


@pytest.mark.parametrize("thin", [1e-3, 1e-5, 1e-7, 1e-9, 1e-11])
@pytest.mark.parametrize("name", ON_MESHES)
def test_badly_conditioned_meshes_are_deformed_within_reason_or_refused(name, thin, shape):
    vertices, faces = bar()
    a, b, c = faces[50]
    sliver = vertices.copy()
    sliver[c] = (vertices[a] + vertices[b]) / 2 + thin * (vertices[c] - (vertices[a] + vertices[b]) / 2)
    flat = vertices * [1, thin, 1]
    for x in (sliver, flat):
        p = x[[x[:, 0].argmin(), x[:, 0].argmax()]]
        y = x
        with suppress(NotApplicable):
            y = baselines.get(name)(shape(x, faces), p, np.add(p, [[0, 0, 0], [0, 0.3, 0.3]]))
        assert np.abs(y - x).max() < 1


def test_arap_says_when_its_iterations_do_not_settle(a_bar, monkeypatch):
    import neuralmls_research.baselines.arap as module

    monkeypatch.setattr(module, "UNSETTLED", 1e-12)
    with pytest.raises(NotApplicable, match="does not converge: the last 5 of 50 iterations still move a vertex by"):
        baselines.get("arap")(a_bar, *control_points(lambda p: p * [0.5, 1, 1]))


@pytest.mark.parametrize("degrees", [60, 170])
def test_arap_from_the_rigid_fit_finds_a_rigid_motion_where_from_rest_it_need_not(a_bar, degrees):
    turn, step = np.radians(degrees), np.array([2.0, -1, 0.5])
    rotation = np.array([[np.cos(turn), -np.sin(turn), 0], [np.sin(turn), np.cos(turn), 0], [0, 0, 1]])
    p, q = control_points(lambda p: p @ rotation.T + step)
    y = baselines.get("arap")(a_bar, p, q, start="fit")
    np.testing.assert_allclose(
        y, a_bar.positions @ rotation.T + step, atol=1e-6
    )  # libigl: rotations in single precision


def test_arap_never_starts_from_a_reflection(a_bar):
    p, q = control_points(lambda p: p * [1, 1, -1])  # mirrored: the nearest rotation is none that mirrors
    y = baselines.get("arap")(a_bar, p, q, start="fit")
    sides = (a_bar.positions[a_bar.faces], y[a_bar.faces])
    before, after = (np.einsum("fi,fi->f", x[:, 0], np.cross(x[:, 1], x[:, 2])).sum() for x in sides)
    assert before * after > 0


def test_biharmonic_displacements_are_linear_in_the_targets(a_bar):
    p = TARGET
    moves = np.random.default_rng(0).normal(size=(2, *p.shape))
    bend = baselines.get("biharmonic-displacements")
    a, b, both = (bend(a_bar, p, p + d) - a_bar.positions for d in (*moves, moves.sum(axis=0)))
    np.testing.assert_allclose(a + b, both, atol=1e-6)


def test_arap_keeps_edges_longer_than_classic_weights_do(a_bar):
    p, q = control_points(lambda p: p + np.array([[0, 0, 0], [-0.2, 0.6, 0], [-0.2, 0.6, 0], [0, 0.1, 0]]))
    sides = a_bar.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2).astype(int)

    def stretch(y):
        before, after = (np.linalg.norm(v[sides[:, 0]] - v[sides[:, 1]], axis=1) for v in (a_bar.positions, y))
        return np.abs(np.log(after / before)).mean()

    assert stretch(baselines.get("arap")(a_bar, p, q)) < stretch(baselines.get("classic")(a_bar, p, q))


def test_rbf_meets_an_affine_motion_of_four_control_points(shape):
    rng = np.random.default_rng(1)
    x, p = rng.normal(size=(40, 3)), rng.normal(size=(6, 3))
    a, b = rng.normal(size=(3, 3)), rng.normal(size=3)
    np.testing.assert_allclose(baselines.get("rbf")(shape(x), p, p @ a + b), x @ a + b, atol=1e-9)


def test_rbf_is_the_plain_sum_of_distances(shape):
    rng = np.random.default_rng(2)
    x, p, q = rng.normal(size=(20, 3)), rng.normal(size=(7, 3)), rng.normal(size=(7, 3))
    kernel = -np.linalg.norm(p[:, None] - p, axis=2)
    linear = np.concatenate([np.ones((7, 1)), p], axis=1)
    system = np.block([[kernel, linear], [linear.T, np.zeros((4, 4))]])
    solved = np.linalg.solve(system, np.concatenate([q - p, np.zeros((4, 3))]))
    plain = -np.linalg.norm(x[:, None] - p, axis=2) @ solved[:7] + solved[7] + x @ solved[8:]
    np.testing.assert_allclose(baselines.get("rbf")(shape(x), p, q), x + plain, atol=1e-9)


@pytest.mark.parametrize(
    "p", [[[0, 0, 0]], [[0, 0, 0], [1, 1, 1]], np.eye(3), [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]]]
)
def test_rbf_takes_control_points_that_span_no_volume(p, shape):
    q = np.add(p, np.random.default_rng(3).normal(size=np.shape(p)))
    np.testing.assert_allclose(baselines.get("rbf")(shape(np.concatenate([p, [[2, 3, 4]]])), p, q)[:-1], q, atol=1e-9)


def test_rbf_does_not_throw_far_what_is_beside_control_points_in_almost_a_plane(shape):
    p = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 1e-3]])
    q = np.add(p, [[0, 0, 0], [0, 0, 0.1], [0, 0.1, 0], [0, 0, 0.1]])
    y = baselines.get("rbf")(shape([[0.5, 0.5, 0.5]]), p, q)
    assert np.linalg.norm(y - 0.5) < 0.2


def test_rbf_refuses_two_control_points_in_one_place(shape):
    with pytest.raises(NotApplicable, match="two are in the same"):
        baselines.get("rbf")(shape(np.eye(3)), [[0, 0, 0], [0, 0, 0]], [[0, 0, 0], [0, 0, 1]])


def test_biharmonic_weights_stay_between_their_control_points(a_bar):
    p, q = control_points(lambda p: p + np.array([[0, 0, 0], [0, 1, 0], [0, 1, 0], [0, 0, 0]]))
    moved = baselines.get("biharmonic")(a_bar, p, q) - a_bar.positions
    w = weights(a_bar, p)
    np.testing.assert_allclose(w.sum(axis=1), 1, atol=1e-12)
    np.testing.assert_allclose(moved, w @ (q - p), atol=1e-12)
    assert moved[:, 1].min() >= 0
    assert moved[:, 1].max() <= 1 + 1e-12
    assert not moved[:, [0, 2]].any()


@pytest.mark.parametrize("name", baselines.NAMES)
@pytest.mark.parametrize(
    ("p", "q", "words"),
    [
        ([[0, 0, 0]], [[0, 0, 0], [1, 1, 1]], "found 2"),
        ([[0, 0, np.nan]], [[0, 0, 0]], "not finite"),
        ([[0, 0]], [[0, 0]], "coordinates"),
        (np.empty((0, 3)), np.empty((0, 3)), ""),
    ],
)
def test_control_points_that_make_no_sense_are_refused(name, p, q, words, a_bar):
    with pytest.raises(nm.ArgumentError) as caught:
        baselines.get(name)(a_bar, p, q)
    assert words in str(caught.value)


@pytest.mark.parametrize("name", [name for name in baselines.NAMES if name != "classic"])
def test_shapes_that_are_not_in_space_are_refused(name, shape):
    with pytest.raises(NotApplicable, match="in space"):
        baselines.get(name)(shape(np.eye(2)), [[0, 0, 0]], [[0, 0, 1]])


def test_an_unknown_name_is_answered_with_the_nearest():
    with pytest.raises(nm.ArgumentError, match="'arap'"):
        baselines.get("arpa")


def test_a_missing_library_is_answered_with_what_to_install(monkeypatch, a_bar):
    monkeypatch.setitem(sys.modules, "igl", None)
    with pytest.raises(
        NeuralMLSError,
        match=r"needs igl, which is not installed: pip install neuralmls-research \(in a checkout: ",
    ):
        baselines.get("arap")(a_bar, *control_points(lambda p: p + 1))


def test_the_names_are_there_without_the_libraries():
    program = (
        "import sys, neuralmls_research.baselines as b\nfor name in b.NAMES: b.get(name)\n"
        "print({'igl', 'scipy', 'safetensors'} & {m.split('.')[0] for m in sys.modules})"
    )
    ran = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert ran.stdout.strip() == "set()"


def test_what_is_not_finite_is_never_returned():
    with pytest.raises(NotApplicable, match="not finite"):
        checks.finite("ARAP", np.array([[0.0, np.inf, 0.0]]))
