"""Shapes and the files around them: reading, writing, what goes along, what is refused."""

from __future__ import annotations

import errno
import json
import os
import re
import struct
import sys
import threading
from pathlib import Path

import numpy as np
import pytest

import neuralmls as nm

FACE = "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\n"
TRIANGLE = "mtllib red paint.mtl\n" + FACE


def gltf(folder: Path, buffers: int = 1) -> Path:
    """A triangle for each of some buffers beside the file, and an image."""
    entries = {"buffers": [], "bufferViews": [], "accessors": [], "meshes": [], "nodes": []}
    for i in range(buffers):
        (folder / f"part {i}.bin").write_bytes(struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0))
        entries["buffers"].append({"uri": f"part%20{i}.bin", "byteLength": 36})
        entries["bufferViews"].append({"buffer": i, "byteLength": 36})
        entries["accessors"].append(
            {"bufferView": i, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}
        )
        entries["meshes"].append({"primitives": [{"attributes": {"POSITION": i}}]})
        entries["nodes"].append({"mesh": i, "translation": [i, 0, 0]})
    (folder / "skin.png").write_bytes(b"image")
    entries |= {"images": [{"uri": "skin.png"}], "scenes": [{"nodes": list(range(buffers))}], "scene": 0}
    path = folder / "shape.gltf"
    path.write_text(json.dumps({"asset": {"version": "2.0"}, **entries}))
    return path


def test_a_shape_has_positions_faces_and_bounds(tmp_path):
    path = tmp_path / "a.obj"
    path.write_text(TRIANGLE)
    shape = nm.read(path)
    assert shape.positions.tolist() == [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
    assert shape.faces.tolist() == [[0, 1, 2]]
    assert shape.bounds.tolist() == [[0, 0, 0], [1, 1, 0]]
    assert shape.bounds is shape.bounds, "computed once"
    assert shape.format == "OBJ"
    with pytest.raises(ValueError, match="read-only"):
        shape.positions[0, 0] = 1
    with pytest.raises(ValueError, match="read-only"):
        shape.bounds[0, 0] = 1


def far_away(folder: Path, kind: str = "<f4") -> nm.Shape:
    np.save(folder / "far.npy", np.array([[0, 0, 0], [5e6, 1, 2]], dtype=kind))
    return nm.read(folder / "far.npy")


def test_what_was_written_is_what_is_told(tmp_path):
    shape = far_away(tmp_path)
    asked = shape.positions + np.array([[0, 0, 0], [0.05, 0.25, 0]])
    shape.write(tmp_path / "bent.npy", asked)
    assert np.array_equal(shape.round(asked), np.load(tmp_path / "bent.npy"))
    assert shape.round(asked)[1].tolist() == [5e6, 1.25, 2]
    assert shape.round([[5e6 + 0.3, 0, 0]]).tolist() == [[5e6 + 0.5, 0, 0]], "a place that is no vertex"
    assert shape.step() == 0.5
    assert far_away(tmp_path, "<f8").step() == 0
    with pytest.raises(nm.ArgumentError, match="points: expected 3 coordinates a point"):
        shape.round([[0, 0]])


@pytest.mark.parametrize("name", ["cloud.asc", "cloud.pts", "cloud.NEU", "cloud.xyzrgb", "cloud"])
def test_the_own_ending_of_a_file_is_always_right(tmp_path, name):
    (tmp_path / name).write_text("2\n0 0 0 7\n1 1 1 8\n")
    shape = nm.read(tmp_path / name)
    target = (tmp_path / "bent").with_suffix(Path(name).suffix)
    shape.write(target, shape.positions + 0.5)
    assert target.read_text() == "2\n0.5 0.5 0.5 7\n1.5 1.5 1.5 8\n"
    assert nm.read(target).format == shape.format
    with pytest.raises(nm.FileError, match=r"bent\.ply: expected the ending \.xyz"):
        shape.write(tmp_path / "bent.ply", shape.positions)


def test_materials_and_textures_go_along_into_another_folder(tmp_path):
    here, there = tmp_path / "here", tmp_path / "there"
    (here / "images").mkdir(parents=True)
    there.mkdir()
    (here / "a.obj").write_text(TRIANGLE)
    (here / "red paint.mtl").write_text("newmtl red\nmap_Kd -s 1 1 1 images/red wood.png\nbump ../outside.png\n")
    (here / "images" / "red wood.png").write_bytes(b"wood")
    (tmp_path / "outside.png").write_bytes(b"outside")
    shape = nm.read(here / "a.obj")
    outside = "'../outside.png', which the shape names, leads out of its folder: it is left behind"
    with pytest.warns(UserWarning, match=f"^{re.escape(outside)}$"):
        written = shape.write(there / "b.obj", shape.positions + 1)
    assert [str(path.relative_to(there)) for path in written] == ["b.obj", "red paint.mtl", "images/red wood.png"]
    assert (there / "images" / "red wood.png").read_bytes() == b"wood"
    (here / "red paint.mtl").write_text("newmtl red\nmap_Kd -s 1 1 1 images/red wood.png\n")
    (there / "red paint.mtl").write_bytes((here / "red paint.mtl").read_bytes())
    assert [path.name for path in shape.write(there / "c.obj", shape.positions)] == ["c.obj"]
    assert [path.name for path in shape.write(here / "b.obj", shape.positions)] == ["b.obj"]


@pytest.mark.parametrize("library", [r"materials\a.mtl", "materials/a.mtl", r".\materials\a.mtl"])
@pytest.mark.parametrize("image", [r"wood\oak.png", "wood/oak.png"])
def test_names_are_found_by_either_slash(tmp_path, library, image):
    here, there = tmp_path / "here", tmp_path / "there"
    (here / "materials" / "wood").mkdir(parents=True)
    there.mkdir()
    (here / "a.obj").write_text(f"mtllib {library}\n{FACE}")
    (here / "materials" / "a.mtl").write_text(f"newmtl red\nmap_Kd -clamp on {image}\n")
    (here / "materials" / "wood" / "oak.png").write_bytes(b"oak")
    shape = nm.read(here / "a.obj")
    assert len(shape.companions) == 2
    shape.write(there / "b.obj", shape.positions)
    assert (there / "materials" / "wood" / "oak.png").read_bytes() == b"oak"


def test_what_is_missing_is_named(tmp_path):
    path = tmp_path / "a.obj"
    path.write_text(TRIANGLE)
    shape = nm.read(path)
    assert shape.look_beside().missing == ["red paint.mtl"]
    with pytest.warns(UserWarning, match="is not there") as warned:
        shape.write(tmp_path / "b.obj", shape.positions)
    assert [str(each.message) for each in warned] == [
        "'red paint.mtl', which the shape names, is not there: it goes without"
    ]
    (tmp_path / "red paint.mtl").write_text(
        "map_Kd -s 1 1 1 -clamp on big oak.png\nbump C:\\tex\\a.png\nmap_Ka \nmap_Ks b.png\n"
    )
    (tmp_path / "b.png").write_bytes(b"")
    assert shape.look_beside().missing == ["big oak.png", "C:/tex/a.png"]
    assert list(shape.companions) == ["red paint.mtl", "b.png"]


@pytest.mark.skipif(sys.platform == "win32", reason="links need a privilege there")
def test_links_that_lead_out_of_the_folder_are_neither_read_nor_copied(tmp_path):
    here, there = tmp_path / "here", tmp_path / "there"
    (here / "own").mkdir(parents=True)
    there.mkdir()
    (tmp_path / "secret").mkdir()
    (tmp_path / "secret" / "key").write_text("secret")
    (here / "a.obj").write_text("mtllib a.mtl\nmtllib out.mtl\n" + FACE)
    (here / "a.mtl").write_text("map_Kd out.png\nmap_Ks folder/key\nmap_Ka in.png\nbump round.png\n")
    (here / "own" / "oak.png").write_bytes(b"oak")
    for name, target in {
        "out.mtl": tmp_path / "secret" / "key",
        "out.png": "../secret/key",
        "folder": "../secret",
        "in.png": "own/oak.png",
        "round.png": "round.png",
    }.items():
        (here / name).symlink_to(target)
    shape = nm.read(here / "a.obj")
    beside = shape.look_beside()
    assert beside.refused == ["out.mtl", "out.png", "folder/key"]
    assert beside.missing == ["round.png"]
    assert list(shape.companions) == ["a.mtl", "in.png"]
    with pytest.warns(UserWarning, match="leads out of its folder: it is left behind|is not there"):
        shape.write(there / "b.obj", shape.positions)
    assert sorted(path.name for path in there.rglob("*")) == ["a.mtl", "b.obj", "in.png"]
    assert not (there / "in.png").is_symlink()


@pytest.mark.skipif(sys.platform == "win32", reason="links need a privilege there")
def test_a_buffer_that_is_a_link_out_of_the_folder_is_not_read(tmp_path):
    folder = tmp_path / "folder"
    folder.mkdir()
    path = gltf(folder)
    (folder / "part 0.bin").rename(tmp_path / "part 0.bin")
    (folder / "part 0.bin").symlink_to("../part 0.bin")
    with pytest.raises(
        nm.FileError, match=r"shape\.gltf: buffers\[0\]\.uri: \"part 0\.bin\": 'part 0\.bin' leaves the shape's"
    ):
        nm.read(path)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="this system has no named pipes")
def test_pipes_and_devices_beside_a_shape_are_not_waited_for(tmp_path):
    path = gltf(tmp_path)
    (tmp_path / "part 0.bin").unlink()
    os.mkfifo(tmp_path / "part 0.bin")
    with pytest.raises(nm.FileError, match=r"cannot read 'part 0\.bin' beside it: this is a pipe, not a file"):
        nm.read(path)
    os.mkfifo(tmp_path / "pipe.obj")
    with pytest.raises(nm.FileError, match=r"pipe\.obj: cannot read: this is a pipe, not a file"):
        nm.read(tmp_path / "pipe.obj")
    (tmp_path / "a.obj").write_text("mtllib a.mtl\n" + FACE)
    os.mkfifo(tmp_path / "a.mtl")
    assert nm.read(tmp_path / "a.obj").look_beside().missing == ["a.mtl"]


@pytest.mark.skipif(not os.path.isdir("/dev/fd"), reason="this system does not name the pipes of a process")
def test_a_pipe_of_the_shell_is_read_to_its_end():
    reader, writer = os.pipe()
    os.write(writer, FACE.encode())
    os.close(writer)
    assert len(nm.read(f"/dev/fd/{reader}").positions) == 3
    os.close(reader)


def test_a_companion_with_another_content_is_kept_and_named(tmp_path):
    here, there = tmp_path / "here", tmp_path / "there"
    here.mkdir()
    there.mkdir()
    (here / "a.obj").write_text(TRIANGLE)
    (here / "red paint.mtl").write_text("newmtl red\nmap_Kd wood.png\n")
    (here / "wood.png").write_bytes(b"wood")
    (there / "red paint.mtl").write_text("mine")
    shape = nm.read(here / "a.obj")
    with pytest.warns(UserWarning, match="kept") as warned:
        written = shape.write(there / "b.obj", shape.positions + 1)
    assert [str(warning.message) for warning in warned] == [
        f"{there / 'red paint.mtl'}: kept, although it is not the '{here / 'red paint.mtl'}' that the shape names"
    ]
    assert warned[0].filename == __file__
    assert [path.name for path in written] == ["b.obj", "wood.png"]
    assert (there / "red paint.mtl").read_text() == "mine"


def test_buffers_that_change_are_called_after_the_new_file(tmp_path):
    path = gltf(tmp_path, buffers=2)
    before = {name: (tmp_path / name).read_bytes() for name in ("shape.gltf", "part 0.bin", "part 1.bin")}
    shape = nm.read(path)
    written = shape.write(tmp_path / "bent it.gltf", shape.positions + np.array([0, 0, 1]))
    assert [path.name for path in written] == ["bent it.gltf", "bent it.bin", "bent it-2.bin"]
    assert "bent%20it-2.bin" in (tmp_path / "bent it.gltf").read_text()
    assert np.array_equal(nm.read(tmp_path / "bent it.gltf").positions, shape.positions + np.array([0, 0, 1]))
    for name, content in before.items():
        assert (tmp_path / name).read_bytes() == content, "the original is untouched"


def test_a_scene_opens_in_another_folder(tmp_path):
    there = tmp_path / "there"
    there.mkdir()
    shape = nm.read(gltf(tmp_path, buffers=2))
    y = shape.positions.copy()
    y[4] += 0.5  # of the second buffer alone
    written = shape.write(there / "bent.gltf", y)
    assert {path.name for path in written} == {"bent.gltf", "bent.bin", "part 0.bin", "skin.png"}
    assert np.array_equal(nm.read(there / "bent.gltf").positions, y)
    same = tmp_path / "same"
    same.mkdir()
    shape.write(same / "shape.gltf", shape.positions)
    assert (same / "shape.gltf").read_bytes() == (tmp_path / "shape.gltf").read_bytes()
    assert np.array_equal(nm.read(same / "shape.gltf").positions, shape.positions)


def test_a_set_of_files_is_written_whole_or_not_at_all(tmp_path, monkeypatch):
    """Scene and buffers replace those that were read, so that half of the set would be the end of both."""
    there = tmp_path / "there"
    there.mkdir()
    nm.read(gltf(tmp_path, buffers=2)).write(there / "shape.gltf", nm.read(tmp_path / "shape.gltf").positions + 1)
    shape = nm.read(there / "shape.gltf")
    before = {file.name: file.read_bytes() for file in there.iterdir()}
    assert set(before) == {"shape.gltf", "shape.bin", "shape-2.bin", "skin.png"}
    full_after(monkeypatch, 2)
    with pytest.raises(nm.FileError, match=r"shape\.gltf: cannot write: No space left on device$"):
        shape.write(there / "shape.gltf", shape.positions + 1)
    assert {file.name: file.read_bytes() for file in there.iterdir()} == before
    monkeypatch.undo()
    shape.write(there / "shape.gltf", shape.positions + 1)
    assert np.array_equal(nm.read(there / "shape.gltf").positions, shape.positions + 1)


def test_companions_that_cannot_be_copied_leave_the_shape_unwritten(tmp_path, monkeypatch):
    there = tmp_path / "there"
    there.mkdir()
    (there / "b.obj").write_text("precious")
    (tmp_path / "a.obj").write_text(TRIANGLE)
    (tmp_path / "red paint.mtl").write_text("newmtl red\n")
    shape = nm.read(tmp_path / "a.obj")
    full_after(monkeypatch, 0)
    with pytest.raises(nm.FileError, match=r"red paint\.mtl: cannot write: No space left on device$"):
        shape.write(there / "b.obj", shape.positions + 1)
    assert {file.name: file.read_bytes() for file in there.iterdir()} == {"b.obj": b"precious"}


def full_after(monkeypatch, count):
    """A disk that has room for so many files."""
    room = iter(range(count))

    def sync(_descriptor):
        if next(room, None) is None:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, "fsync", sync)


def test_a_companion_with_the_name_of_the_output_does_not_take_its_place(tmp_path):
    there = tmp_path / "there"
    there.mkdir()
    (tmp_path / "a.obj").write_text(TRIANGLE.replace("red paint.mtl", "b.obj"))
    (tmp_path / "b.obj").write_text("newmtl red\n")
    shape = nm.read(tmp_path / "a.obj")
    assert shape.write(there / "b.obj", shape.positions + 1) == [there / "b.obj"]
    assert np.array_equal(nm.read(there / "b.obj").positions, shape.positions + 1)


@pytest.mark.skipif(sys.platform in ("win32", "darwin"), reason="names are Unicode here")
def test_names_that_are_no_text_are_written(tmp_path):
    shape = nm.read(gltf(tmp_path))
    path = tmp_path / os.fsdecode(b"bent \xff.gltf")
    assert [os.fsencode(file.name) for file in shape.write(path, shape.positions + 1)] == [
        b"bent \xff.gltf",
        "bent \N{REPLACEMENT CHARACTER}.bin".encode(),
    ]
    assert np.array_equal(nm.read(path).positions, shape.positions + 1)


def test_names_as_long_as_the_disk_takes_them_are_written(tmp_path):
    path = tmp_path / ("\N{CHAIR}" * 62 + ".obj")
    path.write_text(FACE)
    shape = nm.read(path)
    assert shape.write(path, shape.positions + 1) == [path]


def test_nothing_is_replaced_without_leave(tmp_path):
    shape = nm.read(gltf(tmp_path))
    (tmp_path / "bent.bin").write_bytes(b"mine")
    with pytest.raises(nm.ArgumentError, match=r"bent\.bin: there is such a file already"):
        shape.write(tmp_path / "bent.gltf", shape.positions + 1, overwrite=False)
    assert not (tmp_path / "bent.gltf").exists()
    assert (tmp_path / "bent.bin").read_bytes() == b"mine"


@pytest.mark.parametrize(
    "uri", ["/etc/hostname", "../secret.bin", "https://example.org/a.bin", "C:/a.bin", "a/../../b"]
)
def test_buffers_outside_of_the_folder_are_not_read(tmp_path, uri):
    path = gltf(tmp_path)
    path.write_text(path.read_text().replace("part%200.bin", uri))
    with pytest.raises(nm.FileError, match=r"shape\.gltf: buffers\[0\]\.uri"):
        nm.read(path)


def test_positions_and_maps_must_fit(tmp_path):
    path = tmp_path / "a.obj"
    path.write_text(TRIANGLE)
    shape = nm.read(path)
    for positions, maps, sentence in (
        (shape.positions[:2], None, "expected 3 positions"),
        (shape.positions[:, :2], None, "expected 3 coordinates a point"),
        (shape.positions, np.zeros((2, 3, 3)), "3 x 3 map for each position"),
        (shape.positions, np.zeros((3, 9)), r"expected an \(n, d, d\) array"),
        (shape.positions * np.nan, None, "not finite"),
    ):
        with pytest.raises(nm.ArgumentError, match=sentence):
            shape.write(tmp_path / "b.obj", positions, maps=maps)
    with pytest.raises(nm.FileError, match=r"b\.ply: expected the ending \.obj"):
        shape.write(tmp_path / "b.ply", shape.positions)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.obj"]


def test_what_is_no_path_is_refused(tmp_path):
    (tmp_path / "a.obj").write_text(TRIANGLE)
    shape = nm.read(tmp_path / "a.obj")
    points = nm.ControlPoints([[0, 0, 0]])
    for call in (nm.read, nm.ControlPoints.read, points.write, lambda path: shape.write(path, shape.positions)):
        for path in (None, "a\0.obj", "a\ud800.obj"):
            with pytest.raises(nm.ArgumentError, match=re.escape(f"path: expected the path of a file, found {path!r}")):
                call(path)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="this system has no named pipes")
def test_a_named_pipe_is_written_to_although_nothing_may_be_replaced(tmp_path):
    source, pipe = tmp_path / "a.obj", tmp_path / "pipe.obj"
    source.write_text(FACE)
    os.mkfifo(pipe)
    received: list[str] = []
    reader = threading.Thread(target=lambda: received.append(pipe.read_text()), daemon=True)
    reader.start()
    shape = nm.read(source)
    shape.write(pipe, shape.positions, overwrite=False)
    reader.join(10)
    assert received == [FACE]
