"""KeypointDeformer: its parts by their laws, with random weights."""

from __future__ import annotations

import numpy as np
import pytest

import neuralmls as nm
from neuralmls.errors import FileError, NeuralMLSError, NotApplicable
from neuralmls_research import baselines
from neuralmls_research.baselines.kpd import KeypointDeformer, network
from neuralmls_research.baselines.kpd.cage import RADIUS, draw_in, icosphere
from neuralmls_research.baselines.kpd.mean_value import mean_value_coordinates
from research.tests.baselines.conftest import bar


class TestCage:
    def test_the_sphere_has_42_vertices_and_80_faces_all_facing_outward(self):
        v, faces = icosphere()
        assert v.shape == (42, 3)
        assert faces.shape == (80, 3)
        np.testing.assert_allclose(np.linalg.norm(v, axis=1), RADIUS, atol=1e-15)
        a, b, c = (v[faces[:, i]] for i in range(3))
        assert (np.einsum("ij,ij->i", np.cross(b - a, c - a), a) > 0).all()
        sides = np.sort(faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
        assert (np.unique(sides, axis=0, return_counts=True)[1] == 2).all()

    def test_it_is_drawn_in_until_it_is_near_the_shape(self):
        v, _ = icosphere()
        drawn = draw_in(v, v * 0.5)
        assert np.linalg.norm(drawn - v * 0.5, axis=1).max() <= 0.4
        np.testing.assert_allclose(np.linalg.norm(drawn, axis=1), RADIUS * 0.99**24, atol=1e-12)

    def test_it_stops_after_a_hundred_steps(self):
        v, _ = icosphere()
        np.testing.assert_allclose(draw_in(v, np.full((1, 3), 9.0)), v * 0.99**100, atol=1e-12)


class TestMeanValueCoordinates:
    v, faces = icosphere()
    inside = np.random.default_rng(0).uniform(-0.7, 0.7, (3000, 3))  # more than one block

    def test_they_sum_to_one_and_give_the_point_back(self):
        w = mean_value_coordinates(self.inside, self.v, self.faces)
        np.testing.assert_allclose(w.sum(axis=1), 1, atol=1e-12)
        np.testing.assert_allclose(w @ self.v, self.inside, atol=1e-9)

    def test_affine_maps_of_the_cage_are_affine_maps_of_the_points(self):
        rng = np.random.default_rng(1)
        a, b = rng.normal(size=(3, 3)), rng.normal(size=3)
        w = mean_value_coordinates(self.inside, self.v, self.faces)
        np.testing.assert_allclose(w @ (self.v @ a + b), self.inside @ a + b, atol=1e-9)

    def test_they_are_positive_inside_of_a_convex_cage(self):
        assert mean_value_coordinates(self.inside, self.v, self.faces).min() > 0

    def test_points_outside_are_given_back_too(self):
        outside = self.inside + np.sign(self.inside) * 2
        w = mean_value_coordinates(outside, self.v, self.faces)
        np.testing.assert_allclose(w @ self.v, outside, atol=1e-7)
        assert w.min() < 0

    def test_a_vertex_of_the_cage_is_that_vertex_alone(self):
        np.testing.assert_array_equal(mean_value_coordinates(self.v, self.v, self.faces), np.eye(42))

    def test_a_point_on_a_face_belongs_to_its_corners(self):
        parts = np.array([0.2, 0.3, 0.5])
        w = mean_value_coordinates(np.einsum("i,fij->fj", parts, self.v[self.faces]), self.v, self.faces)
        for row, face in zip(w, self.faces, strict=True):
            np.testing.assert_allclose(row[face], parts, atol=1e-9)
            assert np.count_nonzero(row) == 3

    def test_a_point_on_an_edge_belongs_to_its_ends(self):
        a, b = self.v[self.faces[:, 0]], self.v[self.faces[:, 1]]
        w = mean_value_coordinates(0.25 * a + 0.75 * b, self.v, self.faces)
        np.testing.assert_allclose(w[np.arange(80), self.faces[:, 1]], 0.75, atol=1e-9)


class TestNetwork:
    def test_keypoints_are_those_of_the_plain_formula(self, tensors):
        x = np.random.default_rng(2).uniform(-1, 1, (30, 3))
        layers = {name: value.astype(np.float64) for name, value in tensors.items()}

        def linear(name, v):
            return np.array([np.dot(row.ravel(), v) for row in layers[f"{name}.weight"]]) + layers[f"{name}.bias"]

        codes = []
        for point in x:
            for i in (1, 2):
                point = np.maximum(linear(f"keypoint_predictor.0.0.conv{i}.conv", point), 0)
            codes.append(linear("keypoint_predictor.0.0.conv3.conv", point))
        code = np.max(codes, axis=0)
        for name in ("0.1", "1.layers.0", "1.layers.1"):
            code = linear(f"keypoint_predictor.{name}.linear", code)
            code = np.where(code < 0, 0.1 * code, code)
        raw = linear("keypoint_predictor.1.layers.2.linear", code)
        expected = [[np.clip(raw[4 * axis + k], -1, 1) for axis in range(3)] for k in range(4)]
        np.testing.assert_allclose(network.keypoints(network.checked(tensors), x), expected, atol=1e-12)

    def test_the_order_of_the_vertices_does_not_matter(self, tensors):
        x = np.random.default_rng(3).uniform(-1, 1, (9000, 3))  # more than one block
        layers = network.checked(tensors)
        np.testing.assert_allclose(network.influence(layers, x), network.influence(layers, x[::-1]), atol=1e-12)

    def test_a_keypoint_moves_the_nearest_vertices_of_the_cage_alone(self):
        v, _ = icosphere()
        near = network.near(v[:4] * 0.9, v)
        assert (near.sum(axis=1) >= 10).all()
        assert near[np.arange(4), np.arange(4)].all()

    @pytest.mark.parametrize(
        ("name", "value", "words"),
        [
            ("influence_param", None, "no KeypointDeformer"),
            (
                "influence_predictor.1.0.linear.bias",
                None,
                "'influence_predictor.1.0.linear.bias' of shape (168,), found none",
            ),
            ("keypoint_predictor.0.0.conv1.conv.weight", np.zeros((64, 3), np.float32), "found one of shape (64, 3)"),
            ("keypoint_predictor.0.1.linear.bias", np.full(256, np.nan, np.float32), "finite"),
            ("keypoint_predictor.0.1.linear.bias", np.zeros(256, np.int64), "finite"),
        ],
    )
    def test_tensors_that_do_not_fit_are_named(self, name, value, words, tensors):
        tensors = {key: array for key, array in tensors.items() if key != name}
        if value is not None:
            tensors[name] = value
        with pytest.raises(NeuralMLSError) as caught:
            KeypointDeformer(tensors)
        assert words in str(caught.value)


class TestKeypointDeformer:
    def test_a_file_of_weights_gives_the_network_back(self, tensors, tmp_path, a_bar):
        from safetensors.numpy import save_file

        save_file(tensors, tmp_path / "kpd.safetensors")
        read = KeypointDeformer.read(tmp_path / "kpd.safetensors")
        assert read.count == 4
        assert np.array_equal(read.bind(a_bar).keypoints, KeypointDeformer(tensors).bind(a_bar).keypoints)

    @pytest.mark.parametrize("content", [b"", b"no such file", b"\x08" + bytes(7) + b"{}      ", b"\xff" * 64])
    def test_what_is_no_such_file_is_refused(self, content, tmp_path):
        (tmp_path / "kpd.safetensors").write_bytes(content)
        with pytest.raises(FileError, match=r"kpd\.safetensors: expected a"):
            KeypointDeformer.read(tmp_path / "kpd.safetensors")

    def test_a_missing_file_is_refused(self, tmp_path):
        with pytest.raises(FileError, match="cannot read"):
            KeypointDeformer.read(tmp_path / "none.safetensors")

    def test_unmoved_keypoints_return_the_positions_bit_for_bit(self, tensors, a_bar):
        bound = KeypointDeformer(tensors).bind(a_bar)
        assert np.array_equal(bound.deform(bound.keypoints), a_bar.positions)

    def test_units_and_place_of_the_file_do_not_matter(self, tensors, shape):
        vertices, faces = bar()
        kpd = KeypointDeformer(tensors)
        small, large = kpd.bind(shape(vertices, faces)), kpd.bind(shape(vertices * 100 + 5000, faces))
        np.testing.assert_allclose(large.keypoints, small.keypoints * 100 + 5000, atol=1e-8)
        step = np.random.default_rng(4).normal(size=(4, 3))
        y, z = small.deform(small.keypoints + step), large.deform(large.keypoints + step * 100)
        np.testing.assert_allclose(z, y * 100 + 5000, atol=1e-7)

    def test_the_motion_is_that_of_the_cage(self, tensors, a_bar):
        bound = KeypointDeformer(tensors).bind(a_bar)
        step = np.random.default_rng(5).normal(size=(4, 3))
        cage = bound.cage + bound.influence.T @ step
        expected = bound.coordinates @ cage * bound.scale + bound.centre
        np.testing.assert_allclose(bound.deform(bound.keypoints + step * bound.scale), expected, atol=1e-9)

    def test_as_many_targets_as_keypoints_are_needed(self, tensors, a_bar):
        with pytest.raises(nm.ArgumentError, match="4 keypoints, found 3"):
            KeypointDeformer(tensors).bind(a_bar).deform(np.zeros((3, 3)))

    def test_points_in_one_place_have_no_size(self, tensors, shape):
        with pytest.raises(NotApplicable, match="one place"):
            KeypointDeformer(tensors).bind(shape(np.ones((3, 3))))


class TestBaseline:
    @pytest.fixture
    def spread(self, tensors):
        """A network whose keypoints are apart from each other, whatever the shape."""
        tensors["keypoint_predictor.1.layers.2.linear.weight"][:] = 0
        places = np.array([[-0.5, 0.5, 0, 0], [0, 0, 0.5, 0], [0, 0, 0, 0.5]], dtype=np.float32)
        tensors["keypoint_predictor.1.layers.2.linear.bias"][:] = places.ravel()
        return KeypointDeformer(tensors)

    def test_each_keypoint_goes_with_the_control_point_on_it_in_whatever_order(self, spread, a_bar):
        bound = spread.bind(a_bar)
        step = np.array([[0, 0.1, 0], [0.2, 0, 0], [0, 0, 0]])
        y = baselines.get("kpd")(a_bar, bound.keypoints[[2, 0, 1]], bound.keypoints[[2, 0, 1]] + step, network=spread)
        goals = bound.keypoints.copy()
        goals[[2, 0, 1]] += step
        np.testing.assert_allclose(y, bound.deform(goals), atol=1e-12)
        z = baselines.get("kpd")(a_bar, bound.keypoints[:1], bound.keypoints[:1], network=bound)
        assert np.array_equal(z, a_bar.positions)

    def test_control_points_that_are_no_keypoints_are_refused(self, spread, a_bar):
        p = spread.bind(a_bar).keypoints
        for given, words in (
            (np.add(p, [0, 0.4, 0]), "has none nearby"),
            (np.concatenate([p, p + 0.01]), "4 keypoints, and there are 8"),
        ):
            with pytest.raises(NotApplicable, match=words):
                baselines.get("kpd")(a_bar, given, given, network=spread)

    def test_without_a_network_it_does_not_apply(self, a_bar):
        with pytest.raises(NotApplicable, match="needs a network"):
            baselines.get("kpd")(a_bar, [[0, 0, 0]], [[0, 0, 1]])
