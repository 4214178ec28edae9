"""Too little memory for a shape is an error that can be caught, wherever it runs out."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="limits of memory are Linux's here")

# Reads, rounds and writes a shape with so many MiB more than the process has before.
LIMITED = """
import binascii, resource, sys
import numpy as np
import neuralmls as nm
nm.read
pages = int(open("/proc/self/statm").read().split()[0])
limit = pages * resource.getpagesize() + int(float(sys.argv[2]) * 2**20)
resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
try:
    shape = nm.read(sys.argv[1])
    shape.round(shape.positions)
    y = shape.positions + 0.5
    shape.encode(y)
except MemoryError as error:
    print("MemoryError:", error)
else:
    print("done")
"""
# The same of the command line.
COMMAND = """
import resource, sys
import numpy, neuralmls.shape, neuralmls.cli.inspect, neuralmls.cli.inputs
from neuralmls.cli import main
pages = int(open("/proc/self/statm").read().split()[0])
limit = pages * resource.getpagesize() + int(float(sys.argv.pop(1)) * 2**20)
resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
sys.exit(main())
"""


def grid(side: int) -> tuple[np.ndarray, np.ndarray]:
    """The vertices and the quads of a square grid."""
    x, y = np.meshgrid(np.arange(side, dtype=np.float32), np.arange(side, dtype=np.float32))
    vertices = np.stack([x.ravel(), y.ravel(), np.zeros(side * side, dtype=np.float32)], axis=1)
    at = np.arange(side * side).reshape(side, side)
    return vertices, np.stack([at[:-1, :-1], at[:-1, 1:], at[1:, 1:], at[1:, :-1]], axis=-1).reshape(-1, 4)


def ply(path: Path, side: int) -> Path:
    vertices, quads = grid(side)
    rows = np.zeros(len(quads), dtype=[("count", "u1"), ("corners", "<i4", 4)])
    rows["count"], rows["corners"] = 4, quads
    head = f"ply\nformat binary_little_endian 1.0\nelement vertex {len(vertices)}\n"
    head += "".join(f"property float {axis}\n" for axis in "xyz")
    head += f"element face {len(quads)}\nproperty list uchar int vertex_indices\nend_header\n"
    path.write_bytes(head.encode() + vertices.astype("<f4").tobytes() + rows.tobytes())
    return path


def obj(path: Path, side: int) -> Path:
    vertices, quads = grid(side)
    with open(path, "w") as file:
        np.savetxt(file, vertices, "v %g %g %g")
        file.write("vn 0 0 1\n")
        np.savetxt(file, quads + 1, "f %d//1 %d//1 %d//1 %d//1")
    return path


def npy(path: Path, side: int) -> Path:
    np.save(path, grid(side)[0])
    return path


def glb(path: Path, side: int) -> Path:
    import json
    import struct

    vertices, quads = grid(side)
    corners = quads[:, [0, 1, 2, 0, 2, 3]].astype("<u4")
    data = vertices.astype("<f4").tobytes() + corners.tobytes()
    size = 12 * len(vertices)
    document = {
        "asset": {"version": "2.0"},
        "buffers": [{"byteLength": len(data)}],
        "bufferViews": [
            {"buffer": 0, "byteLength": size},
            {"buffer": 0, "byteOffset": size, "byteLength": 4 * corners.size},
        ],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": len(vertices), "type": "VEC3"},
            {"bufferView": 1, "componentType": 5125, "count": corners.size, "type": "SCALAR"},
        ],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "nodes": [{"mesh": 0}],
    }
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text + struct.pack("<II", len(data), 0x004E4942) + data
    path.write_bytes(struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks)
    return path


@pytest.mark.parametrize("make", [ply, obj, npy, glb])
def test_too_little_memory_is_an_error_and_no_end(tmp_path, make):
    path = make(tmp_path / f"grid.{make.__name__}", 400)
    size = path.stat().st_size / 2**20
    outcomes = []
    for part in (0.2, 0.9, 1.5, 2, 2.6, 3.3, 4, 5, 6.5, 8, 12, 40):
        ran = subprocess.run(
            [sys.executable, "-c", LIMITED, str(path), str(part * size)], capture_output=True, text=True, check=False
        )
        assert (ran.returncode, ran.stderr) == (0, ""), (part, ran.stderr)
        outcomes.append(ran.stdout.split(":")[0].strip())
    assert outcomes[0] == "MemoryError"
    assert outcomes[-1] == "done"


def test_the_command_line_says_so_in_one_sentence(tmp_path):
    path = ply(tmp_path / "grid.ply", 400)
    ran = subprocess.run(
        [sys.executable, "-c", COMMAND, "8", "inspect", str(path)], capture_output=True, text=True, check=False
    )
    assert (ran.returncode, ran.stdout) == (1, "")
    assert ran.stderr == "neuralmls: error: there is not enough memory for this\n"
