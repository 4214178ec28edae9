"""True poses: the figures that were measured before, and files that are not such files."""

from __future__ import annotations

import pickle

import numpy as np
import pytest

import neuralmls as nm
from neuralmls_research.experiments.methods import Bound, Method, Surface, of_shapes
from neuralmls_research.experiments.poses import POSE_METHODS, Poses, pose_errors, read_poses

# QUALITY, point 4: RBF, classic 1/d^4, the paper's weights after 200 steps, ARAP.
MEASURED = {
    ("cat-poses", 12): (3.68, 3.46, 3.96, 5.64),
    ("lion-poses", 12): (3.92, 3.03, 3.05, 3.60),
    ("samba", 12): (2.87, 2.54, 2.65, 1.88),
    ("cat-poses", 40): (1.41, 1.28, 1.31, 1.44),
    ("lion-poses", 40): (1.44, 1.29, 1.34, 1.58),
    ("samba", 40): (1.34, 1.13, 1.03, 0.94),
}


def measured(data, name, count, methods):
    pytest.importorskip("scipy")
    poses = read_poses(data / "poses" / f"{name}.npz")
    return [np.mean(pose_errors(poses, POSE_METHODS[method], count)) for method in methods]


@pytest.mark.parametrize(("name", "count"), MEASURED)
def test_quick_methods_measure_what_was_measured(data, name, count):
    assert measured(data, name, count, ["rbf", "classic"]) == pytest.approx(MEASURED[name, count][:2], rel=0.01)


@pytest.mark.parametrize(("name", "count"), [("lion-poses", 12)])
def test_neural_weights_and_arap_measure_what_was_measured(data, name, count):
    pytest.importorskip("igl")
    assert measured(data, name, count, ["neural", "arap"]) == pytest.approx(MEASURED[name, count][2:], rel=0.05)


def test_what_does_not_hang_on_the_pose_is_done_once(cloud):
    bound = []

    def bind(shape, p):
        bound.append(len(p))
        return Bound(lambda q: shape.positions)

    pose_errors(Poses("several", Surface(cloud, None), np.stack([cloud, cloud + 1, cloud + 2])), Method("m", bind), 5)
    assert bound == [5]


@pytest.fixture
def cloud() -> np.ndarray:
    return np.random.default_rng(0).normal(size=(50, 3))


def test_six_poses_at_most_spread_over_the_file(cloud):
    seen = []

    def remember(shape, p, q):
        seen.append(round(float((q - p).mean()), 6))
        return shape.positions

    poses = Poses("many", Surface(cloud, None), np.stack([cloud + number for number in range(20)]))
    errors = pose_errors(poses, of_shapes("remember", remember), 5)
    assert seen == [0, 3, 7, 11, 15, 19]
    diagonal = np.linalg.norm(np.ptp(cloud, axis=0))
    np.testing.assert_allclose(errors, np.array(seen) * 100 * np.sqrt(3) / diagonal)
    few = Poses("few", Surface(cloud, None), np.stack([cloud, cloud + 1]))
    assert len(pose_errors(few, POSE_METHODS["classic"], 5)) == 2


def test_more_control_points_than_vertices_are_refused(cloud):
    with pytest.raises(nm.ArgumentError, match="few: expected at most 50 control points, found 51"):
        pose_errors(Poses("few", Surface(cloud, None), cloud[None]), POSE_METHODS["classic"], 51)


FACES = np.array([[0, 1, 2]])
REST = np.eye(3)


@pytest.mark.parametrize(
    ("arrays", "words"),
    [
        ({"rest": REST, "poses": REST[None]}, "expected the arrays rest, poses and faces: "),
        ({"rest": REST[:, :2], "poses": REST[None], "faces": FACES}, "rest: expected 3 coordinates a point, found 2"),
        (
            {"rest": REST, "poses": REST, "faces": FACES},
            "poses: expected an array of shape (poses, 3, 3), found",
        ),
        ({"rest": REST, "poses": REST[None, :2], "faces": FACES}, "found (1, 2, 3)"),
        ({"rest": REST, "poses": REST[None][:0], "faces": FACES}, "found (0, 3, 3)"),
        ({"rest": REST, "poses": REST[None] * np.nan, "faces": FACES}, "pose 0: point 0 has a coordinate that is not"),
        ({"rest": REST * 0, "poses": REST[None], "faces": FACES}, "rest: expected at least two vertices in different"),
        ({"rest": REST, "poses": REST[None], "faces": FACES + 1}, "faces: expected vertices 0 to 2, found 1 to 3"),
        ({"rest": REST, "poses": REST[None], "faces": FACES / 2}, "faces: expected an (f, 3) array of whole numbers"),
        ({"rest": np.array([None]), "poses": REST[None], "faces": FACES}, "this is no .npz file of arrays"),
    ],
)
def test_files_that_do_not_fit_are_refused_in_a_sentence(tmp_path, arrays, words):
    path = tmp_path / "bad.npz"
    np.savez(path, **arrays)
    with pytest.raises(nm.FileError) as caught:
        read_poses(path)
    message = str(caught.value)
    assert message.startswith(f"{path}: ")
    assert words in message
    assert "\n" not in message


@pytest.mark.parametrize("content", [b"", b"PK\x03\x04 no", b"text", pickle.dumps([1, 2])])
def test_what_is_no_archive_is_refused(tmp_path, content):
    path = tmp_path / "bad.npz"
    path.write_bytes(content)
    with pytest.raises(nm.FileError, match=r"bad\.npz: "):
        read_poses(path)
    with pytest.raises(nm.FileError, match="cannot read"):
        read_poses(tmp_path / "none.npz")
