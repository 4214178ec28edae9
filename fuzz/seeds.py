"""Small files of every format for the fuzzers to start from: python3 seeds.py FOLDER."""

import base64
import json
import struct
import sys
from pathlib import Path

POSITIONS = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0.5)]
SESSIONS = Path(__file__).parent.parent / "tests" / "sessions"
FACES = [(0, 1, 2), (0, 2, 3)]


def obj() -> dict[str, bytes]:
    return {
        "plain": b"o a\nv 0 0 0\nv 1 0 0\nv 0 1 0.5\nf 1 2 3\n",
        "all": b"# c\r\nmtllib a.mtl\r\nv 0 0 0 1\r\nv 1 0 0 0.5 0.5 1\r\nv 0 1e0 \\\r\n 0\r\nvt 0 1\r\nvn 0 0 1\r\n"
        b"g x y\r\nusemtl oak\r\nf 1/1/1 2/1/1 3/1/1\r\nf -3//-1 -2//1 -1//1\r\nl 1 2\r\np 3\r\n",
        "cloud": b"vn 0 0 1\nv 0 0 0\nvn 1 0 0\nv 1 1 1\n",
        "surface": b"v 0 0 0\nv 1 0 0\nvp 0.5\ncstype bspline\ndeg 1\ncurv 0 1 1 2\nparm u 0 1\nend\n"
        b"surf 0 1 0 1 1 2\n",
    }


def off() -> dict[str, bytes]:
    return {
        "plain": b"OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0.5\n3 0 1 2\n3 0 2 3 255 0 0\n",
        "lines": b"NOFF\n3 1 0\n0 0\n0 0 0 1\n1 0 0\n0 0\n1\n0 1 0 0 0 1\n3\n0 1\n2\n",
        "all": b"# c\r\nSTCNOFF 3 1 0\r\n\r\n0 0 0 0 0 1 1 0 0 1 0 0\r\n1 0 0 0 0 1 1 0 0 1 0 0 # c\r\n"
        b"0 1 0 0 0 1 1 0 0 1 0 0\r\n3 0 1 2\r\n",
    }


def table() -> dict[str, bytes]:
    return {
        "xyz": b"1 2 3 255 0 0\n4 5.5 6 0 0 0\n",
        "csv": b'name,x,y,z,nx,ny,nz\n"a, b",1,2,3,0,0,1\nc,4,5,6,0,1,0\n',
        "cloud": b"//X Y Z Scalar field Nx Ny Nz\n1\n1 2 3 0.5 0 0 1\n",
        "count": b"2\nwater\nO 1 2 3\nH 4 5 6\n",
        "flat": b"//X Y\n1;2\n3;4\n",
        "line": b"1\n2.5e0\n",
    }


def ply() -> dict[str, bytes]:
    def header(kind: str) -> bytes:
        return (
            f"ply\nformat {kind} 1.0\ncomment c\nelement vertex 4\n"
            "property float x\nproperty float y\nproperty float z\n"
            "property float nx\nproperty float ny\nproperty float nz\nproperty uchar red\nelement face 2\n"
            "property list uchar int vertex_indices\nend_header\n"
        ).encode()

    ascii_rows = "".join(f"{x} {y} {z} 0 0 1 7\n" for x, y, z in POSITIONS)
    ascii_rows += "".join("3 {} {} {}\n".format(*face) for face in FACES)

    def binary(order: str) -> bytes:
        rows = b"".join(struct.pack(order + "6fB", *p, 0, 0, 1, 7) for p in POSITIONS)
        return rows + b"".join(struct.pack(order + "B3i", 3, *face) for face in FACES)

    return {
        "ascii": header("ascii") + ascii_rows.encode(),
        "little": header("binary_little_endian") + binary("<"),
        "big": header("binary_big_endian") + binary(">"),
        "double": b"ply\nformat ascii 1.0\nCreated by hand\nelement vertex 1\n"
        b"property double x\nproperty double y\nproperty double z\n"
        b"property list uchar float tags\nend_header\n1 2 3 2 0.5 0.25\n",
    }


def stl() -> dict[str, bytes]:
    def facet(face: tuple[int, ...]) -> str:
        corners = "".join("      vertex {} {} {}\n".format(*POSITIONS[i]) for i in face)
        return f"  facet normal 0 0 1\n    outer loop\n{corners}    endloop\n  endfacet\n"

    solid = "solid a\n" + "".join(facet(face) for face in FACES) + "endsolid a\n"
    records = b"".join(
        struct.pack("<12fH", 0, 0, 1, *(c for i in face for c in POSITIONS[i]), 0x8001) for face in FACES
    )
    return {
        "ascii": solid.encode(),
        "two": (solid + solid).encode(),
        "mark": b"\xef\xbb\xbf" + solid.encode(),
        "open": b"a header".ljust(84, b"\0") + records,
        "binary": b"a header".ljust(80, b"\0") + struct.pack("<I", len(FACES)) + records,
    }


def gltf_parts() -> tuple[dict, bytes]:
    indices = struct.pack("<6H", *(i for face in FACES for i in face))
    points = b"".join(struct.pack("<3f", *p) for p in POSITIONS)
    normals = struct.pack("<3f", 0, 0, 1) * 4
    document = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [
            {"children": [1, 2], "translation": [1, 2, 3]},
            {"mesh": 0, "rotation": [0, 0, 0.6, 0.8], "scale": [2, 1, 1]},
            {"mesh": 0, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 0, 0, 1]},
        ],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 1, "NORMAL": 2}, "indices": 0}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5123, "count": 6, "type": "SCALAR"},
            {"bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0.5]},
            {"bufferView": 2, "componentType": 5126, "count": 4, "type": "VEC3"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": 12},
            {"buffer": 0, "byteOffset": 12, "byteLength": 48},
            {"buffer": 0, "byteOffset": 60, "byteLength": 48},
        ],
        "buffers": [{"byteLength": 108}],
    }
    return document, indices + points + normals


def gltf() -> dict[str, bytes]:
    document, data = gltf_parts()
    document["buffers"][0]["uri"] = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
    single = json.loads(json.dumps(document))
    single["nodes"] = [{"mesh": 0}]
    return {"instances": json.dumps(document).encode(), "single": json.dumps(single, indent=1).encode()}


def glb() -> dict[str, bytes]:
    document, data = gltf_parts()
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    data += b"\0" * (-len(data) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text + struct.pack("<II", len(data), 0x004E4942) + data
    return {"instances": struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks}


def npy() -> dict[str, bytes]:
    def array(kind: str, shape: tuple[int, ...], data: bytes, fortran: bool = False) -> bytes:
        header = f"{{'descr': '{kind}', 'fortran_order': {fortran}, 'shape': {shape}, }}"
        header = header.ljust(-(10 + len(header) + 1) % 64 + len(header)) + "\n"
        return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header.encode() + data

    return {
        "f4": array("<f4", (2, 3), struct.pack("<6f", *range(6))),
        "f8": array(">f8", (3, 2), struct.pack(">6d", *range(6)), fortran=True),
        "image": array("<f4", (2, 2, 3), struct.pack("<12f", *range(12)), fortran=True),
        "i4": array("<i4", (2, 1), struct.pack("<2i", 1, 2)),
    }


def map() -> dict[str, bytes]:
    """Saved maps: of inverse-distance weights, and of a network of two neurons a layer (crates/session/src/map_file.rs)."""
    points = [{"name": name, "position": [x, 0], "target": [x, 1]} for name, x in (("a", 0), ("b", 1))]
    document = {"format": "neuralmls-control-points", "version": 2, "control_points": points}
    frame = {"control_points": ("F64", [2, 2], [0, 0, 1, 0]), "centre": ("F64", [2], [0.5, 0]), "half": ("F64", [1], [0.5])}
    classic = {"alpha": ("F64", [1], [1]), "epsilon": ("F64", [1], [0])}
    network = {"losses": ("F64", [1], [0.5]), "loss": ("F64", [1], [0.25]), "frequencies": ("F32", [0, 2], [])}
    for i in range(3):
        network |= {f"weight{i}": ("F32", [2, 2], [1, -1, 0.5, 2]), f"bias{i}": ("F32", [2], [0, 0.5])}
    kinds = {"inverse-distance": (frame | classic, {"alpha": 1, "epsilon": 0}), "neural": (frame | network, {"width": 2})}
    made = {}
    for kind, (arrays, parameters) in kinds.items():
        settings = {"weights": {"kind": kind, **parameters}}
        said = {"version": 1, "weights": kind, "session": document | {"settings": settings}}
        header, data = {"__metadata__": {"neuralmls-map": json.dumps(said)}}, b""
        for name, (dtype, shape, numbers) in arrays.items():
            packed = struct.pack(f"<{len(numbers)}{'d' if dtype == 'F64' else 'f'}", *numbers)
            header[name] = {"dtype": dtype, "shape": shape, "data_offsets": [len(data), len(data) + len(packed)]}
            data += packed
        text = json.dumps(header).encode()
        made[f"{kind}.map"] = struct.pack("<Q", len(text)) + text + data
    return made


def session() -> dict[str, bytes]:
    """The files of tests/sessions."""
    files = [path for path in SESSIONS.glob("*/*") if path.stat().st_size < 4096]
    return {f"{path.parent.name}-{path.name}": path.read_bytes() for path in files}


def main(folder: Path) -> None:
    for make in (obj, off, table, ply, stl, gltf, glb, npy, session, map):
        target = folder / make.__name__
        target.mkdir(parents=True, exist_ok=True)
        for name, content in make().items():
            (target / name).write_bytes(content)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
