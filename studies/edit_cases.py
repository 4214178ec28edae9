"""Edits of the manufactured shapes of the data, made by a script: which, and where their control points are.

Control points are put by one rule on all shapes: the middles of the soles, where there are legs, and vertices as far
from all others as can be, each with its mirror image. Shapes of the paper have the paper's own, and its displacements.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
from edit_motions import (
    FLOOR,
    FRONT,
    RIGHT,
    TOP,
    UP,
    Array,
    Motion,
    flared,
    leaned,
    legs,
    longer,
    swept,
    turned,
    wider,
)

import neuralmls as nm
from neuralmls_research.experiments.published import published

COUNT = 12
PAPER = ("ShapeNetChair1", "ShapeNetChair3", "chair2", "ShapeNetPlane1", "ShapeNetPlane2")
LOW = 0.04  # of the height: what is a sole
NEAR = 0.2  # in halves of the longest side: what belongs to the same foot as the point farthest out
BESIDE = 0.1  # in halves: what is no farther from a control point gets no other
STANDS = 0.02  # of the longest side: a foot that is moved by less stands
UPWARD = np.array([0.0, 1, 0])


@dataclass(frozen=True)
class Subject:
    """A shape of the data, which axis is its front (up is y), and whether it stands on four legs or wheels."""

    file: str
    front: str = "+z"
    feet: bool = True

    @property
    def axes(self) -> Array:
        """Right, up and front, as rows."""
        front = np.zeros(3)
        front["xyz".index(self.front[1])] = 1.0 if self.front[0] == "+" else -1.0
        return np.stack([np.cross(UPWARD, front), UPWARD, front])


@dataclass(frozen=True)
class Edit:
    """One edit of a shape, control points (m, 3) from `p` to `q`; `feet` are those that stand on the floor and move."""

    name: str
    shape: nm.Shape
    p: Array
    q: Array
    feet: tuple[int, ...] = ()

    @property
    def side(self) -> float:
        """The longest side of the shape's box."""
        return float(np.ptp(self.shape.bounds, axis=0).max())

    @property
    def asked(self) -> float:
        """The greatest stretch that the control points themselves ask for, between any two of them; at least 1."""
        before, after = (np.linalg.norm(at[:, None] - at, axis=2) for at in (self.p, self.q))
        return max(1.0, float((after[before > 0] / before[before > 0]).max(initial=1.0)))


CASE = Subject("cases/shape-aware-legs/model.obj", "+x")
CHAIR1, CHAIR3 = (Subject(f"shapenet/{name}/model.obj", "+x") for name in ("ShapeNetChair1", "ShapeNetChair3"))
CHAIR2 = Subject("shapenet/chair2/model.obj", "+x")
PLANE1, PLANE2 = (
    Subject(f"shapenet/{name}/model.obj", "+x", feet=False) for name in ("ShapeNetPlane1", "ShapeNetPlane2")
)
OAK = Subject("manufactured/oakChair/oakChair.obj")
OFFICE = Subject("manufactured/office-chair/office-chair.obj")
PLASTIC = Subject("manufactured/plasticChair/plasticChair.obj")
DESIGN = Subject("manufactured/designChair/designChair.obj", feet=False)
SHEEN = Subject("manufactured/SheenChair/SheenChair.gltf")
BEETLE = Subject("manufactured/VW-new-beetle/VW-new-beetle.obj")
SMART = Subject("manufactured/smart-car/smart-car.obj")
BIPLANE = Subject("manufactured/cartoon_biplane/cartoon_biplane.obj", feet=False)
SPRING = Subject("manufactured/motorbike/motorbike.obj", "+x", feet=False)
BAR, CACTUS = (Subject(f"botsch_sorkine/{name}.off", feet=False) for name in ("bar", "cactus"))


def furniture(name: str) -> Subject:
    """A piece of KayKit's furniture."""
    return Subject(f"manufactured/kaykit_furniture/{name}.gltf", feet=name != "lamp_standing")


def car(name: str) -> Subject:
    """One of KayKit's cars."""
    return Subject(f"manufactured/kaykit_cars/car_{name}.gltf")


def vehicle(name: str) -> Subject:
    """One of Kenney's vehicles."""
    return Subject(f"manufactured/kenney/vehicle-{name}.glb", feet=name != "motorcycle")


EDITS: list[tuple[str, Subject, Motion]] = [
    ("case, back leaned", CASE, leaned(-0.1, 20)),
    ("case, legs splayed", CASE, flared(UP, -0.2, FLOOR, 0.5)),
    ("Chair1, legs longer", CHAIR1, legs(-0.1, 0.5)),
    ("Chair1, back leaned", CHAIR1, leaned(0.0, 20)),
    ("Chair3, seat wider", CHAIR3, wider(RIGHT, 0.6, 0.4)),
    ("chair2, back leaned", CHAIR2, leaned(0.05, 20)),
    ("Plane1, wings raised", PLANE1, swept(RIGHT, UP, 0.2, 0.3)),
    ("Plane2, nose dropped", PLANE2, turned(RIGHT, FRONT, 0.3, 0.5, 20, np.array([0, 0, 0.3]))),
    ("oak chair, legs longer", OAK, legs(-0.1, 0.5)),
    ("oak chair, seat wider", OAK, wider(RIGHT, 0.6, 0.25)),
    ("oak chair, back leaned", OAK, leaned(-0.05, 20)),
    ("office chair, seat wider", OFFICE, wider(RIGHT, 0.5, 0.2)),
    ("office chair, column longer", OFFICE, longer(UP, -0.6, -0.2, 0.4)),
    ("office chair, back leaned", OFFICE, leaned(0.3, 20)),
    ("plastic chair, legs longer", PLASTIC, legs(-0.1, 0.5)),
    ("plastic chair, seat wider", PLASTIC, wider(RIGHT, 0.6, 0.3)),
    ("design chair, stem longer", DESIGN, longer(UP, -0.8, -0.3, 0.4)),
    ("design chair, shell wider", DESIGN, wider(RIGHT, 0.5, 0.25)),
    ("loveseat, legs longer", SHEEN, legs(-0.2, 0.4)),
    ("loveseat, wider", SHEEN, wider(RIGHT, 0.4, 0.5)),
    ("chair A, legs longer", furniture("chair_A"), legs(-0.4, 0.4)),
    ("chair A, back leaned", furniture("chair_A"), leaned(-0.2, 20)),
    ("chair B, seat wider", furniture("chair_B"), wider(RIGHT, 0.5, 0.3)),
    ("chair B, legs splayed", furniture("chair_B"), flared(UP, -0.4, FLOOR, 0.4)),
    ("chair C, back leaned", furniture("chair_C"), leaned(-0.1, 25)),
    ("chair C, seat deeper", furniture("chair_C"), longer(FRONT, -0.2, 0.5, 0.4)),
    ("stool, legs longer", furniture("chair_stool"), legs(-0.1, 0.6)),
    ("stool, turned over itself", furniture("chair_stool"), turned(UP, UP, FLOOR, TOP, 40)),
    ("armchair, wider", furniture("armchair"), wider(RIGHT, 0.5, 0.4)),
    ("couch, longer", furniture("couch"), wider(RIGHT, 0.6, 0.5)),
    ("lamp, taller", furniture("lamp_standing"), longer(UP, -0.8, 0.2, 0.6)),
    ("lamp, shade wider", furniture("lamp_standing"), flared(UP, 0.0, 0.4, 0.6)),
    ("low table, legs longer", furniture("table_low"), legs(0.3, 0.3)),
    ("table, longer", furniture("table_medium"), wider(RIGHT, 0.6, 0.5)),
    ("table, legs longer", furniture("table_medium"), legs(0.5, 0.4)),
    ("beetle, longer", BEETLE, wider(FRONT, 0.3, 0.3)),
    ("beetle, roof higher", BEETLE, longer(UP, 0.1, 0.8, 0.15)),
    ("smart, longer", SMART, wider(FRONT, 0.3, 0.4)),
    ("smart, wider", SMART, wider(RIGHT, 0.5, 0.2)),
    ("hatchback, rear longer", car("hatchback"), longer(FRONT, -0.2, -0.8, -0.4)),
    ("police car, wider", car("police"), wider(RIGHT, 0.5, 0.2)),
    ("sedan, cabin longer", car("sedan"), longer(FRONT, 0.3, -0.4, -0.4)),
    ("station wagon, roof lower", car("stationwagon"), longer(UP, 0.1, 0.8, -0.12)),
    ("taxi, bonnet longer", car("taxi"), longer(FRONT, 0.2, 0.8, 0.4)),
    ("motorcycle, fork longer", vehicle("motorcycle"), longer(FRONT, 0.2, 0.6, 0.3)),
    ("green truck, bed longer", vehicle("truck-green"), longer(FRONT, -0.1, -0.6, -0.4)),
    ("purple truck, cabin higher", vehicle("truck-purple"), longer(UP, 0.0, 0.8, 0.2)),
    ("red truck, wider", vehicle("truck-red"), wider(RIGHT, 0.5, 0.2)),
    ("yellow truck, bonnet longer", vehicle("truck-yellow"), longer(FRONT, 0.2, 0.7, 0.4)),
    ("spring rider, spring longer", SPRING, longer(UP, -0.9, -0.4, 0.3)),
    ("biplane, wings swept", BIPLANE, swept(RIGHT, FRONT, 0.15, -0.4)),
    ("biplane, wings longer", BIPLANE, wider(RIGHT, 0.5, 0.3)),
    ("biplane, tail longer", BIPLANE, longer(FRONT, 0.1, -0.6, -0.4)),
    ("bar, twisted", BAR, turned(FRONT, FRONT, FLOOR, TOP, 90)),
    ("bar, bent", BAR, turned(RIGHT, FRONT, 0.0, 0.3, 45)),
    ("cactus, longer", CACTUS, longer(FRONT, 0.2, 0.8, 0.4)),
]  # fmt: skip


def edits(data: Path, only: str = "") -> Iterator[Edit]:
    """All edits whose name has `only` in it: the case that broke, the paper's, and those of `EDITS`."""
    for name, file in (("case, legs longer", "points.json"), ("case, seat wider", "wide.json")):
        if only in name:
            points = nm.Session.read(data / "cases" / "shape-aware-legs" / file).points
            yield _edit(name, read(data / CASE.file), points.sources, points.targets, UPWARD)
    for name in PAPER:
        for displacement, points in _published(data, name).items():
            title = f"{name.removeprefix('ShapeNet')}, {displacement.replace('_', ' ')}"
            if only in title and (points.sources != points.targets).any():
                shape = read(data / "shapenet" / name / "model.obj")
                yield _edit(title, shape, points.sources, points.targets, None if "Plane" in name else UPWARD)
    for name, subject, motion in EDITS:
        if only in name:
            yield edited(name, data, subject, motion)


def edited(name: str, data: Path, subject: Subject, motion: Motion) -> Edit:
    """The control points of a shape where a motion takes them."""
    shape = read(data / subject.file)
    low, high = shape.bounds
    centre, half = (low + high) / 2, float((high - low).max()) / 2
    p = control_points(data, subject)
    axes = subject.axes
    extents = np.abs(axes @ ((high - low) / 2 / half))
    q = motion((p - centre) / half @ axes.T, extents) @ axes * half + centre
    return _edit(name, shape, p, np.where(np.abs(q - p) > 1e-12 * half, q, p), axes[UP] if subject.feet else None)


@cache
def control_points(data: Path, subject: Subject) -> Array:
    """The control points of a shape: its own, or by the rule."""
    path = Path(subject.file)
    if subject == CASE:
        return nm.Session.read(data / "cases" / "shape-aware-legs" / "points.json").points.sources
    if path.parent.name in PAPER:
        return next(iter(_published(data, path.parent.name).values())).sources
    shape = read(data / subject.file)
    low, high = shape.bounds
    centre, half = (low + high) / 2, float((high - low).max()) / 2
    axes = subject.axes
    u = (shape.positions - centre) / half @ axes.T
    chosen = soles(u) if subject.feet else np.empty((0, 3))
    return spread(u, chosen) @ axes * half + centre


def soles(u: Array) -> Array:
    """The middles of the four soles: of what is low, and near to what is farthest out in each of the four corners."""
    extents = np.abs(u).max(axis=0)
    low = u[u[:, UP] < (LOW * 2 - 1) * extents[UP]]
    found = []
    for right, front in ((1, 1), (1, -1), (-1, 1), (-1, -1)):
        outmost = low[(right * low[:, RIGHT] / extents[RIGHT] + front * low[:, FRONT] / extents[FRONT]).argmax()]
        foot = low[np.linalg.norm(low - outmost, axis=1) < NEAR]
        found.append((foot.min(axis=0) + foot.max(axis=0)) / 2)
    return np.array(found)


def spread(places: Array, chosen: Array) -> Array:
    """At most `COUNT` points: those chosen, then always the place farthest from all of them, and its mirror image."""
    points = list(chosen) or [places[np.linalg.norm(places, axis=1).argmax()]]
    away = np.linalg.norm(places[:, None] - np.array(points), axis=2).min(axis=1)
    while len(points) < COUNT and away.max() > BESIDE:
        found = places[away.argmax()]
        mirrored = places[np.linalg.norm(places - found * [-1, 1, 1], axis=1).argmin()]
        for point in (found, mirrored)[: COUNT - len(points)]:
            if np.linalg.norm(point - np.array(points), axis=1).min() > BESIDE:
                points.append(point)
                away = np.minimum(away, np.linalg.norm(places - point, axis=1))
    return np.array(points)


def _edit(name: str, shape: nm.Shape, p: Array, q: Array, up: Array | None) -> Edit:
    """An edit; its feet are the control points in the lowest tenth of them that are moved by more than `STANDS`."""
    if up is None:
        return Edit(name, shape, p, q)
    height = p @ up
    low = height < height.min() + 0.1 * np.ptp(height)
    moved = np.linalg.norm(q - p, axis=1) > STANDS * np.ptp(shape.bounds, axis=0).max()
    return Edit(name, shape, p, q, tuple(np.flatnonzero(low & moved).tolist()))


@cache
def read(path: Path) -> nm.Shape:
    """A shape of the data, read once."""
    return nm.read(path)


@cache
def _published(data: Path, name: str) -> dict[str, nm.ControlPoints]:
    found = published(data, name)
    if found is None:
        raise SystemExit(f"{data}: expected the paper's shapes, but there is no shapenet/{name}")
    return found.displacements
