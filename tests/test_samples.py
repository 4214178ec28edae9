"""The sample shapes: what manufactured files are like, with control points where a user would put them."""

from collections import Counter
from pathlib import Path

import numpy as np
import pytest
import trimesh

from neuralmls.errors import ArgumentError, FileError
from neuralmls.samples import NAMES, make
from neuralmls.samples.sample import write_obj


def edge_counts(faces: list[list[int]]) -> Counter[tuple[int, int]]:
    return Counter((min(a, b), max(a, b)) for face in faces for a, b in zip(face, face[1:] + face[:1], strict=True))


@pytest.mark.parametrize("name", NAMES)
def test_a_sample_is_a_manufactured_shape(name: str) -> None:
    sample = make(name)
    faces, n = sample.faces, len(sample.vertices)
    assert 5_000 <= n <= 15_000
    assert {i for face in faces for i in face} == set(range(n))  # no loose vertex
    assert all(len(set(face)) == len(face) >= 3 for face in faces)
    assert {4} < {len(face) for face in faces}  # quads and others
    assert len(sample.parts) >= 10
    assert len({part.name for part in sample.parts}) == len(sample.parts)
    assert {part.material for part in sample.parts} <= set(sample.materials)
    counts = Counter(edge_counts(faces).values())
    assert counts[1] > 0, "open sheets"
    assert sum(count for faces_there, count in counts.items() if faces_there > 2) > 0, "non-manifold edges"
    components = trimesh.Trimesh(sample.vertices, sample.triangles, process=False).body_count
    assert components >= 10


@pytest.mark.parametrize("name", NAMES)
def test_closed_parts_face_outwards(name: str) -> None:
    for part in make(name).parts:
        if set(edge_counts(part.faces).values()) == {2}:
            triangles = [[f[0], f[k], f[k + 1]] for f in part.faces for k in range(1, len(f) - 1)]
            mesh = trimesh.Trimesh(part.vertices, triangles, process=False)
            assert mesh.is_winding_consistent, part.name
            assert all(piece.volume > 0 for piece in mesh.split(only_watertight=False)), part.name


@pytest.mark.parametrize("name", NAMES)
def test_control_points_sit_on_the_shape_and_some_are_moved(name: str) -> None:
    sample = make(name)
    points = sample.control_points
    assert 8 <= len(points) <= 14
    size = float(np.ptp(sample.vertices, axis=0).max())
    nearest = np.linalg.norm(sample.vertices[None] - points.sources[:, None], axis=2).min(axis=1)
    assert (nearest < 0.08 * size).all(), dict(zip(points.names, nearest / size, strict=True))
    moved = np.linalg.norm(points.targets - points.sources, axis=1)
    assert moved.max() > 0.05 * size
    assert points.check([sample.vertices.min(axis=0), sample.vertices.max(axis=0)]) == []


@pytest.mark.parametrize("name", NAMES)
def test_the_obj_file_holds_everything(name: str, tmp_path: Path) -> None:
    sample = make(name)
    write_obj(sample, tmp_path / "shape.obj")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["shape.mtl", "shape.obj"]
    lines = (tmp_path / "shape.obj").read_text(encoding="utf-8").splitlines()
    rows = {key: [line.split()[1:] for line in lines if line.startswith(key + " ")] for key in ("v", "vt", "vn", "f")}
    assert np.array_equal(np.array(rows["v"], dtype=float), sample.vertices)
    corners = [[tuple(int(i) - 1 for i in corner.split("/")) for corner in face] for face in rows["f"]]
    assert [[v for v, _, _ in face] for face in corners] == sample.faces
    assert {n for face in corners for _, _, n in face} == set(range(len(rows["vn"])))
    assert max(t for face in corners for _, t, _ in face) < len(rows["vt"])
    lengths = np.linalg.norm(np.array(rows["vn"], dtype=float), axis=1)
    assert np.abs(lengths - 1).max() < 1e-5
    assert [line[2:] for line in lines if line.startswith("g ")] == [part.name for part in sample.parts]


def test_an_independent_reader_finds_the_same_shape(tmp_path: Path) -> None:
    sample = make("chair")
    write_obj(sample, tmp_path / "chair.obj")
    scene = trimesh.load_scene(tmp_path / "chair.obj", process=False)
    assert len(scene.geometry) == len({part.material for part in sample.parts})
    assert np.allclose(scene.bounds, [sample.vertices.min(axis=0), sample.vertices.max(axis=0)])
    assert sum(len(mesh.faces) for mesh in scene.geometry.values()) == len(sample.triangles)


def test_the_same_sample_is_made_each_time() -> None:
    assert make("car").vertices.tobytes() == make("car").vertices.tobytes()


def test_the_chair_stands_on_its_feet() -> None:
    sample = make("chair")
    assert sample.vertices[:, 1].min() == pytest.approx(0.0, abs=0.002)
    feet = [name for name in sample.control_points.names if name.endswith("foot")]
    assert len(feet) == 4


def test_an_unknown_sample_names_the_nearest(tmp_path: Path) -> None:
    with pytest.raises(ArgumentError, match="no sample 'chiar'; the nearest name is 'chair'"):
        make("chiar")
    with pytest.raises(FileError, match=r"a name that ends in \.obj"):
        write_obj(make("table"), tmp_path / "table.stl")
    with pytest.raises(FileError, match="there is no folder"):
        write_obj(make("table"), tmp_path / "none" / "table.obj")
