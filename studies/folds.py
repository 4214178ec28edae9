"""What maps that fold nothing hold: `python -m studies.folds FOLDER`; FOLDER holds `organic/` and `shapenet/`.

Drags: every control point of ten shapes is moved by a normal number on each axis, of 10 and 20 % of the longest side;
12 and 40 of them, neural and inverse-distance weights. `det J` (central differences over 1e-4 of the side) is looked at
in 20,000 places on the shape and as many within a tenth of the side around it, none of them those of the search. Bars:
bent and twisted by rings of four control points, and twisted by the degrees of its ends. Ten shapes with five seeds
take half an hour.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import neuralmls as nm
from neuralmls.samples import make

Array = NDArray[np.float64]
Shape = tuple[str, Array, NDArray[np.uint32]]

FILES = (
    "shapenet/ShapeNetChair1/model.obj",
    "shapenet/ShapeNetPlane1/model.obj",
    "organic/armadillo.obj",
    "organic/hand/hand_closed.obj",
    "organic/human/human_neutral.obj",
    "organic/spot/spot_low_resolution.obj",
    "shapenet/ShapeNetChair3/model.obj",
    "shapenet/ShapeNetPlane2/model.obj",
    "organic/bunny/bunny.obj",
)
PLACES, AROUND, STEP = 20_000, 0.1, 1e-4
KINDS = ("neural", "inverse-distance")


def shapes(folder: Path) -> Iterator[Shape]:
    """The sample chair, and those of files."""
    sample = make("chair")
    yield "sample chair", sample.vertices, np.asarray(sample.triangles, dtype=np.uint32)
    for file in FILES:
        shape = nm.read(folder / file)
        assert shape.faces is not None
        yield file.split("/")[-2] if file.count("/") > 1 else "armadillo", shape.positions, shape.faces


def sampled(x: Array, faces: NDArray[np.uint32], count: int, seed: int) -> Array:
    """Places on a surface, by area."""
    rng = np.random.default_rng(seed)
    a, b, c = (x[faces[:, k]] for k in range(3))
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    which = rng.choice(len(faces), count, p=area / area.sum())
    s, t = rng.random((2, count, 1))
    flip = s + t > 1
    s, t = np.where(flip, 1 - s, s), np.where(flip, 1 - t, t)
    return a[which] + s * (b - a)[which] + t * (c - a)[which]


def determinants(map: nm.Map, x: Array, side: float) -> Array:
    """`det J` by central differences."""
    steps = STEP * side * np.eye(3)
    ways = [map.at(x + way * step) for step in steps for way in (1, -1)]
    columns = [(ways[2 * k] - ways[2 * k + 1]) / (2 * STEP * side) for k in range(3)]
    return np.linalg.det(np.stack(columns, axis=-1))


def drag(shape: Shape, count: int, part: float, kind: str, seed: int) -> dict[str, float]:
    """What one drag gives."""
    _, x, faces = shape
    side = float(np.ptp(x, axis=0).max())
    rng = np.random.default_rng(seed)
    p = nm.farthest_points(x, faces, count=count, seed=seed)
    q = p + part * side * rng.normal(size=p.shape)
    session = nm.Session(nm.ControlPoints(p, q), weights=kind)  # type: ignore[arg-type]
    begin = time.perf_counter()
    map = session.replace(no_folds=True).fit(x, faces=faces)
    y = map.at(x)
    seconds = time.perf_counter() - begin
    assert np.isfinite(y).all()
    on = sampled(x, faces, PLACES, 1000 + seed)
    around = on + AROUND * side * rng.uniform(-1, 1, on.shape)
    report = map.report()
    det, off = determinants(map, on, side), determinants(map, around, side)
    one = session.fit(x)
    return {
        "steps": report.steps,
        "folded": float((det <= 0).mean()),
        "around": float((off <= 0).mean()),
        "said": float(report.least is not None and report.least <= 0),
        "least": float(det.min()),
        "miss": float(report.distance_to_target.max()) / side,
        "seconds": seconds,
        "one": float((determinants(one, on, side) <= 0).mean()),
        "off one": float(np.median(np.linalg.norm(y - one.at(x), axis=1))) / side,
    }


def drags(folder: Path, most: int, seeds: int) -> None:
    """A table, a line a kind of run."""
    all_shapes = list(shapes(folder))[:most]
    print(
        "| weights | control points | drag | runs | folded, one step | folded | places on | around | most steps "
        "| miss | s |"
    )
    print("|---|---|---|---|---|---|---|---|---|---|---|")
    for kind in KINDS:
        for count in (12, 40):
            for part in (0.1, 0.2):
                runs = []
                for shape in all_shapes:
                    for seed in range(seeds):
                        run = drag(shape, count, part, kind, seed)
                        runs.append(run)
                        if run["folded"] > 0 or run["around"] > 1e-3 or run["miss"] > 1e-6:
                            print("  ", shape[0], seed, {key: float(f"{value:.3g}") for key, value in run.items()})
                column = {key: np.array([run[key] for run in runs]) for key in runs[0]}
                print(
                    f"| {kind} | {count} | {part:.0%} | {len(runs)} | {(column['one'] > 0).sum()} "
                    f"| {(column['folded'] > 0).sum()} | {column['folded'].max():.2%} | {column['around'].max():.2%} "
                    f"| {column['steps'].max():.0f} | {column['miss'].max():.0e} "
                    f"| {np.median(column['seconds']):.2f} |",
                    flush=True,
                )


def bar() -> tuple[Array, NDArray[np.uint32]]:
    """The surface of a bar along x, 6 x 1 x 1."""
    points, faces = [], []
    for axis, way in ((1, 0.0), (1, 1.0), (2, 0.0), (2, 1.0), (0, 0.0), (0, 1.0)):
        u, v = ((0, 2), (0, 1), (1, 2))[(1, 2, 0).index(axis)]
        sides, first = ((145, 25) if axis else (25, 25)), len(points)
        for i in range(sides[0]):
            for k in range(sides[1]):
                place = np.zeros(3)
                place[axis], place[u], place[v] = way, i / (sides[0] - 1), k / (sides[1] - 1)
                points.append(place * (6, 1, 1) - (3, 0.5, 0.5))
                if i and k:
                    at, down = first + i * sides[1] + k, first + (i - 1) * sides[1] + k
                    faces += [(at, at - 1, down), (down, at - 1, down - 1)]
    return np.array(points), np.array(faces, dtype=np.uint32)


def rotated(x: Array, axis: int, degrees: Array) -> Array:
    """About an axis through the origin, each by its own angle."""
    u, v = (axis + 1) % 3, (axis + 2) % 3
    sin, cos = np.sin(np.radians(degrees)), np.cos(np.radians(degrees))
    y = x.copy()
    y[:, u], y[:, v] = cos * x[:, u] - sin * x[:, v], sin * x[:, u] + cos * x[:, v]
    return y


def bent(x: Array, degrees: float) -> Array:
    """A bar along x bent about z, as long as it was in its middle."""
    radius, angle = 6 / np.radians(degrees), np.radians(degrees) * x[:, 0] / 6
    far = radius - x[:, 1]
    return np.stack([far * np.sin(angle), radius - far * np.cos(angle), x[:, 2]], axis=1)


def rings(count: int) -> Array:
    """Four control points at the corners of each of `count` sections of the bar."""
    corners = [(y, z) for y in (-0.5, 0.5) for z in (-0.5, 0.5)]
    return np.array([(x, y, z) for x in np.linspace(-3, 3, count) for y, z in corners])


def bars() -> None:
    """A table: bends and twists."""
    x, faces = bar()
    cases: list[tuple[str, nm.ControlPoints]] = []
    for degrees in (170, 300):
        p = rings(7)
        cases.append((f"bent by {degrees}, rings", nm.ControlPoints(p, bent(p, degrees))))
    for degrees, count in ((170, 7), (360, 7), (720, 13)):
        p = rings(count)
        cases.append((f"twisted by {degrees}, rings", nm.ControlPoints(p, rotated(p, 0, degrees * (p[:, 0] + 3) / 6))))
    for degrees in (170, 360, 720):
        ends = nm.ControlPoints([[-3.0, 0, 0], [3, 0, 0]], names=["left", "right"])
        turned = {"left": nm.Orientation((1, 0, 0), 0), "right": nm.Orientation((1, 0, 0), degrees)}
        cases.append((f"twisted by {degrees}, ends", ends.oriented(turned)))
    print("| bar | weights | steps | folded | det p1 | median | monotone | miss | one step: folded |")
    print("|---|---|---|---|---|---|---|---|---|")
    on = sampled(x, faces, PLACES, 1)
    for name, points in cases:
        for kind in KINDS:
            session = nm.Session(points, weights=kind)  # type: ignore[arg-type]
            map = session.replace(no_folds=True).fit(x, faces=faces)
            det, report = determinants(map, on, 6.0), map.report()
            one = determinants(session.fit(x), on, 6.0)
            print(
                f"| {name} | {kind} | {report.steps} | {(det <= 0).mean():.2%} | {np.quantile(det, 0.01):.2f} "
                f"| {np.median(det):.2f} | {monotone(map, name)} | {report.distance_to_target.max() / 6:.0e} "
                f"| {(one <= 0).mean():.1%} |",
                flush=True,
            )


def monotone(map: nm.Map, name: str) -> str:
    """Whether the bar's sections turn the same way all along, to a hundredth of the whole, and by how much in all."""
    along, around = np.linspace(-2.99, 2.99, 200), np.linspace(0, 2 * np.pi, 24, endpoint=False)
    arms = 0.4 * np.stack([np.zeros(24), np.cos(around), np.sin(around)], axis=1)
    y = map.at((np.array([1.0, 0, 0]) * along[:, None, None] + arms).reshape(-1, 3)).reshape(200, 24, 3)
    y -= y.mean(axis=1, keepdims=True)
    u, v, arm = (0, 1, (-1, 0)) if name.startswith("bent") else (2, 1, (1, 0))
    # The rotation in the plane u, v that fits the section best.
    b, c = arms[:, 1], arms[:, 2]
    sin, cos = (y[..., u] * b).sum(axis=1) * arm[0], (y[..., v] * b).sum(axis=1)
    if not name.startswith("bent"):
        sin, cos = sin - (y[..., 1] * c).sum(axis=1), cos + (y[..., 2] * c).sum(axis=1)
    angle = np.degrees(np.unwrap(np.arctan2(sin, cos)))
    back, whole = -np.diff(angle).min(), angle[-1] - angle[0]
    return f"{'yes' if back < 1e-2 * abs(whole) else f'no, back by {back:.2f}'}, {whole:.0f} in all"


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--shapes", type=int, default=10)
    parser.add_argument("--seeds", type=int, default=5)
    said = parser.parse_args()
    bars()
    drags(said.folder, said.shapes, said.seeds)


if __name__ == "__main__":
    main()
