"""Every real file of the test data: unmoved identical, bent with nothing lost to an independent reader, or refused.

`pytest tests/test_real_files.py -s` prints the table: format, file, outcome.
"""

from __future__ import annotations

import io
import json
import warnings
from collections import Counter
from pathlib import Path

import numpy as np
import pytest

import neuralmls as nm

FORMATS = {
    "obj": [".obj"],
    "ply": [".ply"],
    "off": [".off"],
    "stl": [".stl"],
    "gltf": [".gltf", ".glb"],
    "table": [".xyz", ".csv", ".asc", ".pts"],
}
# Fewer than these many would mean that the test looks at nothing.
LEAST = {"obj": 90, "ply": 55, "off": 10, "stl": 25, "gltf": 60, "table": 2}


def bent(shape: nm.Shape) -> tuple[np.ndarray, np.ndarray]:
    """The shape with a few control points on it moved, and the local maps."""
    x = shape.positions
    size = max(float(np.ptp(x, axis=0).max()), 1e-3)
    p = shape.bounds.mean(axis=0) + size * np.array([[0.5, 0, 0], [-0.5, 0.1, 0], [0, 0.5, 0.1], [0, -0.4, 0.5]])
    q = p + size * np.array([[0.1, 0.05, 0], [0, 0, 0], [0.05, 0.2, 0], [0, 0, -0.1]])
    deformer = nm.Deformer(x, nm.InverseDistanceWeights(p[:, : x.shape[1]]))
    return deformer.deform(q[:, : x.shape[1]], return_maps=True)


def moved(shape: nm.Shape, folder: Path) -> tuple[Path, np.ndarray]:
    """The bent shape as a file, its side files copied beside it."""
    y, maps = bent(shape)
    target = folder / shape.path.name  # trimesh names geometry after the file
    assert list(shape.encode(y, maps=maps, stem=target.stem)[1]) == shape.side_files(target.stem), shape.path
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        shape.write(target, y, maps=maps)
    assert [str(each.message) for each in caught] == shape.look_beside().warnings, shape.path
    return target, y


@pytest.mark.parametrize("name", FORMATS)
def test_real_files_come_back_with_nothing_lost(name, data, tmp_path):
    outcomes: Counter[str] = Counter()
    for path in sorted(data.rglob("*")):
        if path.suffix.lower() not in FORMATS[name] or not path.is_file():
            continue
        try:
            shape = nm.read(path)
        except nm.FileError as error:
            sentence = str(error).removeprefix(f"{path}: ")
            assert 0 < len(sentence) < 400
            assert "\n" not in sentence
            outcome = f"refused: {sentence}"
        else:
            folder = tmp_path / f"{sum(outcomes.values())}"
            folder.mkdir()
            unmoved, _ = shape.encode(shape.positions)
            assert unmoved == path.read_bytes(), path
            target, y = moved(shape, folder)
            again = nm.read(target)
            assert np.array_equal(again.positions, shape.round(y)), path
            size = np.ptp(y, axis=0).max()
            # Single precision around the largest coordinate, or whole numbers.
            step = 1e-5 * size + 1e-6 * np.abs(y).max() + (0.51 if "rounded" in str(shape.facts) else 0)
            assert np.abs(again.positions - y).max() <= step, path
            assert (again.faces is None) == (shape.faces is None)
            assert shape.faces is None or np.array_equal(again.faces, shape.faces), path
            outcome = "kept; " + INDEPENDENT[name](path, target, y)
        print(f"{name:<6} {str(path.relative_to(data))[-58:]:<58} {outcome[:150]}")
        outcomes[outcome.split(":")[0]] += 1
    print(f"{name}: {dict(outcomes)}")
    assert outcomes.total() - outcomes["refused"] >= LEAST[name]
    seen = sum(count for outcome, count in outcomes.items() if outcome.endswith("agrees"))
    assert seen >= 0.6 * (outcomes.total() - outcomes["refused"])


def quietly(load, path: Path):
    """What another library reads, or None where it cannot read the original at all."""
    try:
        return load(path)
    except Exception:
        return None


def with_trimesh(path: Path):
    import trimesh

    kind = path.suffix[1:].lower()
    with open(path, "rb") as file, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        resolver = trimesh.resolvers.FilePathResolver(path)
        return trimesh.load_scene(file, file_type=kind, resolver=resolver, process=False, maintain_order=True)


def trimesh_agrees(path: Path, target: Path, _y: np.ndarray) -> str:
    before = quietly(with_trimesh, path)
    if before is None or not before.geometry:
        return "trimesh does not read it"
    after = with_trimesh(target)
    assert list(after.geometry) == list(before.geometry), path
    for key, a in before.geometry.items():
        b = after.geometry[key]
        assert a.vertices.shape == b.vertices.shape, path
        if hasattr(a, "faces"):
            assert np.array_equal(a.faces, b.faces), path
        if hasattr(a, "entities"):
            assert len(a.entities) == len(b.entities), path
        visual, other = getattr(a, "visual", None), getattr(b, "visual", None)
        if getattr(visual, "uv", None) is not None:
            assert np.array_equal(visual.uv, other.uv, equal_nan=True), path
        if hasattr(visual, "material"):
            assert visual.material.name == other.material.name, path
        if getattr(visual, "kind", None) in ("vertex", "face"):
            assert np.array_equal(visual.vertex_colors, other.vertex_colors), path
    return "trimesh agrees"


def plyfile_agrees(path: Path, target: Path, y: np.ndarray) -> str:
    import plyfile

    before = quietly(plyfile.PlyData.read, path)
    if before is None:
        return "plyfile does not read it"
    after = plyfile.PlyData.read(target)
    assert [e.name for e in after] == [e.name for e in before]
    assert after.comments == before.comments
    assert after.obj_info == before.obj_info
    for a, b in zip(before, after, strict=True):
        moving = {"x", "y", "z", "nx", "ny", "nz", "normal_x", "normal_y", "normal_z"} if a.name == "vertex" else set()
        for column in a.data.dtype.names:
            if column not in moving:
                equal = all(np.array_equal(u, v, equal_nan=u.dtype.kind == "f") for u, v in lists(a, b, column))
                assert equal, f"{path}: {a.name}.{column}"
    if before["vertex"].data["x"].dtype.kind == "f":
        xyz = np.stack([after["vertex"].data[axis] for axis in "xyz"], axis=1)
        assert np.abs(xyz - y).max() <= 1e-6 * np.abs(y).max() + 1e-6
    return "plyfile agrees"


def lists(a, b, column: str):
    u, v = a.data[column], b.data[column]
    return zip(u, v, strict=True) if u.dtype == object else [(u, v)]


def gltf_agrees(path: Path, target: Path, _y: np.ndarray) -> str:
    """Everything but positions, normals and tangents is as it was, through pygltflib's own reading of the file."""
    import pygltflib

    before = quietly(pygltflib.GLTF2().load, path)
    if before is None:
        return "pygltflib does not read it"
    after = pygltflib.GLTF2().load(target)
    for kept in ("scenes", "materials", "textures", "images", "samplers", "skins", "cameras", "extensions", "extras"):
        if kept != "images" or path.suffix == ".gltf":
            assert as_json(getattr(after, kept)) == as_json(getattr(before, kept)), f"{path}: {kept}"
    for a, b in zip(before.nodes or [], after.nodes or [], strict=True):
        assert {**as_json(a), "mesh": 0} == {**as_json(b), "mesh": 0}, path
        if a.mesh is None or before.meshes is None:
            continue
        for u, v in zip(before.meshes[a.mesh].primitives, after.meshes[b.mesh].primitives, strict=True):
            assert (u.material, u.mode, as_json(u.extensions)) == (v.material, v.mode, as_json(v.extensions))
            assert content(before, path, u.indices) == content(after, target, v.indices), path
            names = {k: i for k, i in as_json(u.attributes).items() if i is not None}
            others = {k: i for k, i in as_json(v.attributes).items() if i is not None}
            assert names.keys() == others.keys()
            for attribute in names.keys() - {"POSITION", "NORMAL", "TANGENT"}:
                assert content(before, path, names[attribute]) == content(after, target, others[attribute]), attribute
            for s, t in zip(u.targets or [], v.targets or [], strict=True):
                for attribute in s:
                    assert content(before, path, s[attribute]) == content(after, target, t[attribute]), path
    for a, b in zip(before.animations or [], after.animations or [], strict=True):
        for s, t in zip(a.samplers, b.samplers, strict=True):
            assert content(before, path, s.input) == content(after, target, t.input), path
            assert content(before, path, s.output) == content(after, target, t.output), path
    return "pygltflib agrees"


def as_json(value):
    return json.loads(json.dumps(value, default=lambda o: o.__dict__))


def content(gltf, path: Path, index: int | None) -> bytes | None:
    """The numbers of an accessor, as bytes without padding."""
    if index is None:
        return None
    accessor = gltf.accessors[index]
    size = {5120: 1, 5121: 1, 5122: 2, 5123: 2, 5125: 4, 5126: 4}[accessor.componentType]
    size *= {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}[accessor.type]
    if accessor.bufferView is None:
        return bytes(size * accessor.count)
    view = gltf.bufferViews[accessor.bufferView]
    buffer = gltf.buffers[view.buffer]
    if buffer.uri is None:
        raw = gltf.binary_blob()
    elif buffer.uri.startswith("data:"):
        import base64

        raw = base64.b64decode(buffer.uri.split(",", 1)[1])
    else:
        from urllib.parse import unquote

        raw = (path.parent / unquote(buffer.uri)).read_bytes()
    start = (view.byteOffset or 0) + (accessor.byteOffset or 0)
    step = view.byteStride or size
    file = io.BytesIO()
    for i in range(accessor.count):
        file.write(raw[start + i * step : start + i * step + size])
    return file.getvalue() + json.dumps(as_json(accessor.sparse)).encode()


def numpy_agrees(path: Path, target: Path, _y: np.ndarray) -> str:
    columns = dict(nm.read(path).facts)["columns of the position"].split(", ")
    moving = {int(column) - 1 for column in columns}
    before, after = (p.read_text().splitlines() for p in (path, target))
    assert len(before) == len(after)
    for a, b in zip(before, after, strict=True):
        u, v = (line.replace(",", " ").replace(";", " ").split() for line in (a, b))
        assert [w for i, w in enumerate(u) if i not in moving] == [w for i, w in enumerate(v) if i not in moving], path
    return "plain splitting agrees"


INDEPENDENT = {
    "obj": trimesh_agrees,
    "ply": plyfile_agrees,
    "off": trimesh_agrees,
    "stl": trimesh_agrees,
    "gltf": gltf_agrees,
    "table": numpy_agrees,
}
