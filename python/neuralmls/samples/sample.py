"""A sample shape, put together from parts, and its OBJ file."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from neuralmls.control_points import ControlPoints
from neuralmls.errors import FileError
from neuralmls.files import write_together
from neuralmls.samples.parts import Part

CREASE = 40.0  # degrees; faces that meet at a sharper angle are shaded apart
DIGITS = 6  # a micrometre

Colour = tuple[float, float, float]


@dataclass(frozen=True)
class Sample:
    """A shape of several parts, with control points that are already moved in a way that makes sense.

    Attributes
    ----------
    name : str
    parts : list of Part
        One group of the OBJ file each.
    materials : dict
        Diffuse colour (red, green, blue), 0 to 1, of each material.
    control_points : ControlPoints
    """

    name: str
    parts: list[Part]
    materials: dict[str, Colour]
    control_points: ControlPoints

    @property
    def vertices(self) -> NDArray[np.float64]:
        """All vertices, (n, 3), in metres, as the file has them."""
        return np.concatenate([part.vertices for part in self.parts]).round(DIGITS) + 0.0

    @property
    def faces(self) -> list[list[int]]:
        """All polygons as indices of `vertices`: quads, triangles and n-gons."""
        faces, base = [], 0
        for part in self.parts:
            faces += [[base + i for i in face] for face in part.faces]
            base += len(part.vertices)
        return faces

    @property
    def triangles(self) -> NDArray[np.int64]:
        """The polygons cut into triangles, (f, 3), each as a fan about its first corner."""
        return np.array([[f[0], f[k], f[k + 1]] for f in self.faces for k in range(1, len(f) - 1)], dtype=np.int64)

    @property
    def colours(self) -> NDArray[np.float64]:
        """The colour of each vertex's material, (n, 3), 0 to 1."""
        return np.concatenate([np.tile(self.materials[part.material], (len(part.vertices), 1)) for part in self.parts])


def write_obj(sample: Sample, path: str | os.PathLike[str]) -> None:
    """Write a sample as an OBJ file with groups, materials, normals and texture coordinates, the MTL file beside it.

    Raises
    ------
    FileError
        `path` does not end in .obj, or cannot be written.
    """
    target = Path(path)
    if target.suffix.lower() != ".obj":
        raise FileError(f"{path}: expected a name that ends in .obj")
    library = target.with_suffix(".mtl")
    write_together(
        {library: _mtl(sample).encode(), target: _obj(sample, library.name).encode(errors="surrogateescape")}
    )


def _mtl(sample: Sample) -> str:
    lines = [f"# Materials of the NeuralMLS sample '{sample.name}'"]
    for name, colour in sample.materials.items():
        diffuse = " ".join(f"{value:.3f}" for value in colour)
        lines += ["", f"newmtl {name}", f"Kd {diffuse}", "Ks 0.100 0.100 0.100", "Ns 40.0", "illum 2"]
    return "\n".join(lines) + "\n"


def _obj(sample: Sample, library: str) -> str:
    lines = [f"# NeuralMLS sample '{sample.name}', in metres, y up", f"mtllib {library}"]
    v_base = vt_base = vn_base = 1
    for part in sample.parts:
        normals, normal_faces = corner_normals(part)
        lines += ["", f"g {part.name}", f"usemtl {part.material}"]
        lines += ["v " + _numbers(v) for v in part.vertices]
        lines += ["vt " + _numbers(vt) for vt in part.uvs]
        lines += ["vn " + _numbers(vn) for vn in normals]
        for face, uv_face, normal_face in zip(part.faces, part.uv_faces, normal_faces, strict=True):
            corners = zip(face, uv_face, normal_face, strict=True)
            lines.append("f " + " ".join(f"{v_base + v}/{vt_base + t}/{vn_base + n}" for v, t, n in corners))
        v_base, vt_base, vn_base = (
            v_base + len(part.vertices),
            vt_base + len(part.uvs),
            vn_base + len(normals),
        )
    return "\n".join(lines) + "\n"


def _numbers(values: NDArray[np.float64]) -> str:
    return " ".join(f"{value:.{DIGITS}f}" for value in values.round(DIGITS) + 0.0)


def corner_normals(part: Part) -> tuple[NDArray[np.float64], list[list[int]]]:
    """A normal for each corner: the mean over the faces about its vertex that turn by less than the crease angle."""
    face_normals = np.array([_newell(part.vertices[face]) for face in part.faces])
    areas = np.linalg.norm(face_normals, axis=1, keepdims=True)
    units = face_normals / np.maximum(areas, 1e-30)
    around: list[list[int]] = [[] for _ in part.vertices]
    for f, face in enumerate(part.faces):
        for v in face:
            around[v].append(f)
    limit = np.cos(np.radians(CREASE))
    index: dict[tuple[float, ...], int] = {}
    faces = []
    for f, face in enumerate(part.faces):
        corners = []
        for v in face:
            near = around[v]
            mean = face_normals[near][units[near] @ units[f] >= limit].sum(axis=0)
            unit = mean / max(float(np.linalg.norm(mean)), 1e-30)
            corners.append(index.setdefault(tuple((unit.round(DIGITS) + 0.0).tolist()), len(index)))
        faces.append(corners)
    return np.array(list(index)), faces


def _newell(polygon: NDArray[np.float64]) -> NDArray[np.float64]:
    """The area vector of a polygon that need not be flat."""
    centred = polygon - polygon.mean(axis=0)
    total: NDArray[np.float64] = np.cross(centred, np.roll(centred, -1, axis=0)).sum(axis=0) / 2
    return total
