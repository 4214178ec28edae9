"""The shapes of the experiments: the paper's where the data is there, else our own, which say so."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from neuralmls import ControlPoints, read
from neuralmls.samples import make
from neuralmls_research.baselines.kpd import KeypointDeformer
from neuralmls_research.experiments.methods import Surface
from neuralmls_research.experiments.published import published
from neuralmls_research.experiments.reproduce.lab import Lab

Array = NDArray[np.float64]
Faces = NDArray[np.int64]

# Control points of ours on the armadillo of the data, and how they move: it waves, and lifts a foot and its tail.
ARMADILLO = {
    "right hand": ((-0.36, 0.29, 0.20), (-0.10, 0.18, -0.10)),
    "right elbow": ((-0.30, 0.14, 0.02), (-0.02, 0.03, 0.0)),
    "left hand": ((0.37, 0.20, 0.24), (0.05, -0.32, 0.05)),
    "left elbow": ((0.28, 0.16, 0.02), (0.0, -0.08, 0.0)),
    "head": ((0.0, 0.27, 0.20), (0.0, 0.0, 0.0)),
    "chest": ((0.0, 0.08, 0.0), (0.0, 0.0, 0.0)),
    "pelvis": ((0.0, -0.13, -0.10), (0.0, 0.0, 0.0)),
    "right knee": ((-0.20, -0.25, -0.03), (0.0, 0.0, 0.0)),
    "right foot": ((-0.20, -0.53, 0.0), (0.0, 0.0, 0.0)),
    "left knee": ((0.18, -0.25, -0.05), (0.02, 0.05, 0.12)),
    "left foot": ((0.22, -0.53, -0.02), (0.05, 0.12, 0.10)),
    "tail": ((0.0, -0.27, -0.36), (0.0, 0.25, 0.0)),
}
# Limbs of the creature: a direction, how long, how thin, and how the tip moves.
CREATURE = {
    "left hand": ((1.0, 0.35, 0.2), 1.3, 28.0, (0.1, 0.7, 0.2)),
    "right hand": ((-1.0, 0.35, 0.2), 1.3, 28.0, (-0.1, -0.6, 0.2)),
    "head": ((0.0, 1.0, 0.15), 0.7, 10.0, (0.0, 0.0, 0.0)),
    "left foot": ((0.5, -1.0, 0.1), 1.4, 26.0, (0.0, 0.0, 0.0)),
    "right foot": ((-0.5, -1.0, 0.1), 1.4, 26.0, (0.0, 0.2, 0.6)),
    "tail": ((0.0, -0.25, -1.0), 1.2, 30.0, (0.4, 0.5, 0.0)),
}
# Displacements of cars after the published study's, in halves of the longest side: which keypoints of a car that looks
# along x move, from normalised keypoints (8, 3), and by how much.
CAR_MOVES: dict[str, list[tuple[Callable[[Array], NDArray[np.bool_]], tuple[float, float, float]]]] = {
    "longer": [(lambda p: p[:, 0] > 0.5, (0.3, 0.0, 0.0)), (lambda p: p[:, 0] < -0.5, (-0.2, 0.0, 0.0))],
    "higher": [(lambda p: p[:, 1] > 0.1, (0.0, 0.2, 0.0))],
    "wider": [(lambda p: p[:, 2] < 0.0, (0.0, 0.0, -0.2))],
}
# Our plain chair: boxes by centre and size, x to the front. It gets longer legs and a higher back, as the paper's does.
BOXES = [
    ((0.0, 0.0, 0.0), (1.1, 0.14, 0.96)),
    ((-0.48, 0.52, 0.0), (0.14, 0.9, 0.96)),
    *(((x, -0.5, z), (0.12, 0.86, 0.12)) for x in (-0.48, 0.48) for z in (-0.41, 0.41)),
]
STRETCH = 0.5


@dataclass(frozen=True)
class Subject:
    """A shape and its control points, centred on its box and divided by half of its longest side.

    Attributes
    ----------
    name : str
    origin : str
        Where it comes from, for a caption.
    positions : (n, 3) float64
    faces : (f, 3) int64
    points : ControlPoints
        With targets.
    colours : (n, 3), 0 to 1, or None
    ours : bool
        Whether it stands in for a shape that the paper used.
    scale : float
        Half of the longest side of the file's box.
    view : (float, float)
        Azimuth and elevation of the camera, degrees.
    """

    name: str
    origin: str
    positions: Array
    faces: Faces
    points: ControlPoints
    colours: Array | None = None
    ours: bool = False
    scale: float = 1.0
    view: tuple[float, float] = (32.0, 18.0)

    @property
    def bounds(self) -> Array:
        """The box of the positions, (2, 3)."""
        return np.stack([self.positions.min(axis=0), self.positions.max(axis=0)])

    @property
    def label(self) -> str:
        """Name and origin."""
        return f"{self.name} ({self.origin})"

    @property
    def missing(self) -> list[str]:
        """What a report has to say of a shape that stands in."""
        return [f"The paper's shape: {self.label} stands in ($NEURALMLS_DATA)."] if self.ours else []

    def moved(self, offsets: ArrayLike) -> Subject:
        """The same shape with the control points moved by offsets (m, 3) instead."""
        targets = self.points.sources + np.asarray(offsets, dtype=np.float64)
        points = ControlPoints(self.points.sources, targets, self.points.names)
        return replace(self, points=points)

    def differs_by_displacement(self, other: Subject) -> bool:
        """Whether only the targets differ: the same shape and control points at rest."""
        mine, theirs = ((s.positions, s.faces, s.points.sources) for s in (self, other))
        return all(np.array_equal(a, b) for a, b in zip(mine, theirs, strict=True))


def chair(lab: Lab, case: str = "user_study_1") -> Subject:
    """ShapeNetChair1 with displacements of the user study, else our sample with its own."""
    return _shapenet(lab, "chair", "ShapeNetChair1", case) or _sample("chair")


def plain_chair(lab: Lab) -> Subject:
    """The chair of the paper's sweeps, cut finely so that bending shows, else one of boxes."""
    found = _shapenet(lab, "chair", "chair2", "default") or _box_chair()
    x, faces = cut(found.positions, found.faces, 0.2 if lab.quick else 0.05)
    return replace(found, origin=found.origin + ", cut finely", positions=x, faces=faces)


def airplane(lab: Lab) -> Subject:
    """ShapeNetPlane1 with the default displacements, else our sample."""
    return _shapenet(lab, "airplane", "ShapeNetPlane1", "default") or _sample("airplane")


def chairs(lab: Lab) -> list[Subject]:
    """All chairs and displacements that the paper's authors published; else our sample."""
    study = [(folder, f"user_study_{i}") for folder in ("ShapeNetChair1", "ShapeNetChair3") for i in (1, 2, 3)]
    found = [_shapenet(lab, "chair", folder, case) for folder, case in (*study, ("chair2", "default"))]
    return [subject for subject in found if subject is not None] or [_sample("chair")]


def many(lab: Lab) -> list[Subject]:
    """All shapes and displacements of the paper that the data has, and the organic shape; else all that are ours."""
    found = [
        _shapenet(lab, "airplane" if "Plane" in folder else "chair", folder, case)
        for folder in ("ShapeNetChair1", "ShapeNetChair3", "ShapeNetPlane1", "ShapeNetPlane2")
        for case in ("user_study_1", "user_study_2", "user_study_3")
    ]
    kept = [subject for subject in found if subject is not None] or [_sample(name) for name in ("chair", "airplane")]
    return [*kept, *cars(lab), _sample("table"), organic(lab)]


def cars(lab: Lab) -> list[Subject]:
    """A car with KeypointDeformer's keypoints and displacements like the study's; without its weights, our sample.

    None of the paper's cars is in the data. A car of many loose parts is, which looks along z; so does our sample.
    """
    weights = lab.keypoint_weights("car")
    if weights is None:
        return [_sample("car")]
    path = lab.find("manufactured/VW-new-beetle/VW-new-beetle.obj")
    if path is None:
        made = make("car")
        origin, positions, faces = "our generated sample", made.vertices, made.triangles.astype(np.int64)
    else:
        shape = read(path)
        assert shape.faces is not None
        origin, positions, faces = (
            "a Volkswagen Beetle by Kator and Legaz",
            shape.positions,
            shape.faces.astype(np.int64),
        )
    x = np.stack([positions[:, 2], positions[:, 1], -positions[:, 0]], axis=1)
    bound = KeypointDeformer.read(weights).bind(Surface(x, faces))
    points = ControlPoints(bound.keypoints, bound.keypoints)
    rest = _normalised("car", origin, x, faces, points, ours=True)
    found = []
    for name, moves in CAR_MOVES.items():
        offsets = np.zeros_like(rest.points.sources)
        for chosen, offset in moves:
            offsets[chosen(rest.points.sources)] = offset
        subject = rest.moved(offsets)
        found.append(replace(subject, origin=f"{origin}, {name}", view=(60.0, 20.0)))
    return found


def car(lab: Lab) -> Subject:
    """The first of the cars."""
    return cars(lab)[0]


def organic(lab: Lab) -> Subject:
    """The armadillo, made coarser as in the paper, else a creature of ours: both are closed manifolds."""
    return armadillo(lab, 900 if lab.quick else 8_650) or _creature(3 if lab.quick else 5)


def armadillo(lab: Lab, vertices: int) -> Subject | None:
    """The armadillo with control points of ours, made coarser to about as many vertices; None where it is not here."""
    import pyvista

    path = lab.find("organic/armadillo.obj")
    if path is None:
        return None
    shape = read(path)
    assert shape.faces is not None
    mesh = pyvista.PolyData(shape.positions, np.insert(shape.faces.astype(np.int64), 0, 3, axis=1).ravel())
    mesh = mesh.decimate(1 - vertices / len(shape.positions))
    places, offsets = (np.array(column) for column in zip(*ARMADILLO.values(), strict=True))
    points = ControlPoints(places, places + offsets, list(ARMADILLO))
    x, faces = np.asarray(mesh.points, dtype=np.float64), mesh.faces.reshape(-1, 4)[:, 1:].astype(np.int64)
    return _normalised("armadillo", "made coarser; control points ours", x, faces, points)


def cut(positions: Array, faces: Faces, longest: float) -> tuple[Array, Faces]:
    """Halve edges longer than `longest`, until there is none: the same surface, (n, 3) and (f, 3)."""
    x, triangles = positions, faces
    while True:
        edges = np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=-1)
        length = np.linalg.norm(x[edges[..., 0]] - x[edges[..., 1]], axis=-1)
        side = length.argmax(axis=1)
        rows = np.arange(len(triangles))
        split = length[rows, side] > longest
        if not split.any():
            return x, triangles
        # The longest edge to the front: (a, b, c) becomes (a, middle, c) and (middle, b, c). Neighbours share the
        # middle, because an edge that one of them splits and the other does not yet is split in a later round.
        turned = np.take_along_axis(triangles, (side[:, None] + np.arange(3)) % 3, axis=1)
        ends = np.sort(turned[split, :2], axis=1)
        pairs, index = np.unique(ends, axis=0, return_inverse=True)
        middle = len(x) + index.reshape(-1)
        x = np.concatenate([x, x[pairs].mean(axis=1)])
        a, b, c = turned[split].T
        triangles = np.concatenate([triangles[~split], np.stack([a, middle, c], 1), np.stack([middle, b, c], 1)])


def _normalised(
    name: str,
    origin: str,
    positions: Array,
    faces: Faces,
    points: ControlPoints,
    colours: Array | None = None,
    ours: bool = False,
) -> Subject:
    """A subject from positions and control points in file coordinates."""
    low, high = positions.min(axis=0), positions.max(axis=0)
    centre, scale = (low + high) / 2, float((high - low).max()) / 2
    points = ControlPoints((points.sources - centre) / scale, (points.targets - centre) / scale, points.names)
    return Subject(name, origin, (positions - centre) / scale, faces, points, colours, ours, scale)


def _shapenet(lab: Lab, name: str, folder: str, case: str) -> Subject | None:
    """A shape of the paper with its control points, or None where the data is not there."""
    found = None if lab.data is None else published(lab.data, folder)
    if found is None:
        return None
    shape = found.shape
    assert shape.faces is not None
    faces = shape.faces.astype(np.int64)
    origin = f"the paper's {folder}, {case.replace('_', ' ')}"
    subject = _normalised(name, origin, shape.positions, faces, found.displacements[case])
    return replace(subject, view=(60.0, 30.0))


def _sample(name: str) -> Subject:
    made = make(name)
    return _normalised(
        name, "our generated sample", made.vertices, made.triangles, made.control_points, made.colours, ours=True
    )


def _box_chair() -> Subject:
    """Six boxes that overlap, and ten control points: feet, the legs' upper ends, the back's upper corners."""
    unit = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    triangles = np.array([[q[0], q[i], q[i + 1]] for q in quads for i in (1, 2)])
    positions = np.concatenate([np.array(centre) + unit * size for centre, size in BOXES])
    faces = np.concatenate([triangles + 8 * box for box in range(len(BOXES))])
    feet = [(x, -0.9, z) for x in (-0.48, 0.48) for z in (-0.41, 0.41)]
    tops = [(-0.48, 0.95, z) for z in (-0.45, 0.45)]
    p = np.array([*feet, *((x, 0.0, z) for x, _, z in feet), *tops])
    offsets = np.zeros_like(p)
    offsets[:4, 1], offsets[8:, 1] = -STRETCH, STRETCH
    subject = _normalised("chair", "ours, of six boxes", positions, faces, ControlPoints(p, p + offsets), ours=True)
    return replace(subject, view=(60.0, 30.0))


def _creature(rounds: int) -> Subject:
    """A sphere with limbs pulled out of it: closed, manifold, smooth."""
    import pyvista

    sphere = pyvista.Icosphere(nsub=rounds)
    u = np.asarray(sphere.points, dtype=np.float64)
    u /= np.linalg.norm(u, axis=1, keepdims=True)
    radius = np.ones(len(u))
    places, offsets = [(0.0, 0.0, 0.0)], [(0.0, 0.0, 0.0)]
    for direction, length, thinness, offset in CREATURE.values():
        towards = np.array(direction) / np.linalg.norm(direction)
        radius += length * np.exp(thinness * (u @ towards - 1.0))
        places.append(tuple(towards * (0.9 + length)))
        offsets.append(offset)
    faces = sphere.faces.reshape(-1, 4)[:, 1:].astype(np.int64)
    p = np.array(places)
    points = ControlPoints(p, p + np.array(offsets), ["body", *CREATURE])
    return _normalised("creature", "ours, made from a sphere", u * radius[:, None], faces, points, ours=True)
