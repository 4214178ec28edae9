"""Articulated shapes made by code, at rest and in true poses: what the settings of shape-aware weights are chosen on.

A creature is a skeleton of tapered bones. Its surface is a level set of the smooth union of the bones, or, for
furniture, a box a bone that is a component of its own. A pose turns every bone about its head, and a vertex follows the
bone that it lies on, blended with that bone's neighbours in the skeleton only; a box follows its bone alone.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import pyvista as pv
from numpy.typing import NDArray

from neuralmls_research.experiments.methods import Surface
from neuralmls_research.experiments.poses import Poses

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
BEND = 1.6  # of every joint, in what its bone says
ALIKE = 0.8  # of a bend, in paired poses: what left and right have in common
SPACING = 1 / 48  # of the grid on which a level set is found, in longest sides

Turned = tuple[Array, Array]  # axes (bones, 3), and how far of its greatest bend each bone turns (bones,)


@dataclass(frozen=True)
class Bone:
    """From head to tail, as thick as `radii` there; bends by up to `bend` degrees about its head."""

    parent: int
    head: Array
    tail: Array
    radii: tuple[float, float]
    bend: float

    def nearest(self, x: Array) -> Array:
        """The point of the axis that is nearest to a point."""
        along = self.tail - self.head
        return np.asarray(self.head + np.clip((x - self.head) @ along / (along @ along), 0, 1) * along)


class Skeleton:
    """Bones in the order in which they are added, parents first."""

    def __init__(self) -> None:
        self.bones: list[Bone] = []

    def add(self, parent: int, head: object, tail: object, radii: tuple[float, float], bend: float) -> int:
        """Add a bone, and return its number."""
        self.bones.append(Bone(parent, np.array(head, dtype=float), np.array(tail, dtype=float), radii, bend))
        return len(self.bones) - 1

    def chain(self, parent: int, joints: list[Array], radii: tuple[float, float], bend: float) -> int:
        """Add a bone between each two successive joints, tapering; return the last one's number."""
        widths = np.linspace(*radii, len(joints))
        for number, (head, tail) in enumerate(pairwise(joints)):
            parent = self.add(parent, head, tail, (widths[number], widths[number + 1]), bend)
        return parent

    def distances(self, x: Array) -> Array:
        """Signed distances of points (n, 3) to the bones: (n, bones)."""
        columns = []
        for bone in self.bones:
            along = bone.tail - bone.head
            t = np.clip((x - bone.head) @ along / (along @ along), 0, 1)
            radius = bone.radii[0] + t * (bone.radii[1] - bone.radii[0])
            columns.append(np.linalg.norm(x - bone.head - t[:, None] * along, axis=1) - radius)
        return np.stack(columns, axis=1)

    def skin(self, x: Array) -> Array:
        """How much each bone moves each point: (n, bones), rows sum to 1."""
        distances = self.distances(x)
        nearest = distances.argmin(axis=1)
        parents = np.array([bone.parent for bone in self.bones])
        numbers = np.arange(len(parents))
        linked = (parents[:, None] == numbers) | (parents == numbers[:, None]) | np.eye(len(parents), dtype=bool)
        size = np.array([max(bone.radii) for bone in self.bones])
        above = (distances - distances.min(axis=1, keepdims=True)) / (0.35 * size[nearest, None])
        weights = np.where(linked[nearest], np.exp(-np.minimum(above, 50)), 0)
        return np.asarray(weights / weights.sum(axis=1, keepdims=True))

    def pose(self, x: Array, skin: Array, turned: Turned) -> Array:
        """Return the points (n, 3) in the pose that turns the bones so."""
        turns: list[Array] = []
        shifts: list[Array] = []
        for bone, axis, part in zip(self.bones, *turned, strict=True):
            turn = _rotation(axis, np.radians(bone.bend) * part)
            if bone.parent >= 0:
                place = turns[bone.parent] @ bone.head + shifts[bone.parent]
                turn = turns[bone.parent] @ turn
            else:
                place = bone.head
            turns.append(turn)
            shifts.append(place - turn @ bone.head)
        moved = np.einsum("bij,nj->nbi", np.stack(turns), x) + np.stack(shifts)
        return np.einsum("nb,nbi->ni", skin, moved)


def free(skeleton: Skeleton, rng: np.random.Generator) -> Turned:
    """Every joint bends by itself, about any axis."""
    drawn = [(rng.normal(size=3), rng.uniform(-1, 1)) for _ in skeleton.bones]
    return np.stack([axis for axis, _ in drawn]), BEND * np.array([part for _, part in drawn])


def paired(skeleton: Skeleton, rng: np.random.Generator) -> Turned:
    """As animals gallop: joints bend about an axis across the body, more or less, and those of left and right alike."""
    middles = np.array([(bone.head + bone.tail) / 2 for bone in skeleton.bones])
    twins = np.linalg.norm(middles[:, None] - middles * (1, -1, 1), axis=2).argmin(axis=1)
    count = len(middles)
    shared = rng.uniform(-1, 1, count)[np.minimum(np.arange(count), twins)]
    axes = np.array([0, 1, 0]) + 0.3 * rng.normal(size=(count, 3))
    return axes, BEND * (ALIKE * shared + (1 - ALIKE) * rng.uniform(-1, 1, count))


def _rotation(axis: Array, angle: float) -> Array:
    a = axis / np.linalg.norm(axis)
    cross = np.cross(np.eye(3), a)
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def level_set(skeleton: Skeleton) -> Surface:
    """The surface of the smooth union of the bones."""
    ends = np.array([end for bone in skeleton.bones for end in (bone.head, bone.tail)])
    margin = max(max(bone.radii) for bone in skeleton.bones) * 1.3
    low, high = ends.min(axis=0) - margin, ends.max(axis=0) + margin
    spacing = SPACING * (high - low).max()
    counts = np.ceil((high - low) / spacing).astype(int) + 1
    grid = pv.ImageData(dimensions=counts, spacing=(spacing,) * 3, origin=low)
    smooth = 0.35 * spacing
    union = -smooth * np.log(np.exp(-np.minimum(skeleton.distances(grid.points), 1) / smooth).sum(axis=1))
    surface = grid.contour([0.0], scalars=union).triangulate().clean()
    return Surface(np.array(surface.points, dtype=float), np.array(surface.faces).reshape(-1, 4)[:, 1:])


def boxes(skeleton: Skeleton) -> Surface:
    """A box around each bone, each a component of its own, of as many vertices as the others."""
    positions, faces, count = [], [], 0
    for bone in skeleton.bones:
        along = bone.tail - bone.head
        length = np.linalg.norm(along)
        # Radii of a box: its half width across two axes.
        frame = np.linalg.svd(np.outer(along, along))[0]
        frame[:, 0] = along / length
        box = pv.Box((0, float(length), -bone.radii[0], bone.radii[0], -bone.radii[1], bone.radii[1]), level=4)
        box = box.triangulate().clean()
        positions.append(bone.head + np.asarray(box.points, dtype=float) @ frame.T)
        faces.append(np.asarray(box.faces).reshape(-1, 4)[:, 1:] + count)
        count += len(box.points)
    return Surface(np.concatenate(positions), np.concatenate(faces))


def four_legged(rng: np.random.Generator) -> Skeleton:
    """A trunk of three bones, neck and head, four legs of three bones, a tail."""
    u = rng.uniform
    s = Skeleton()
    length, height, width, thick = u(0.9, 1.3), u(0.5, 0.8), u(0.11, 0.18), u(0.13, 0.2)
    leg = min(u(0.045, 0.07), 0.42 * width * 1.6)
    rear = s.add(-1, (length / 2, 0, height), (length * 0.17, 0, height), (thick, thick), 15)
    middle = s.add(rear, (length * 0.17, 0, height), (-length * 0.17, 0, height), (thick, thick), 15)
    front = s.add(middle, (-length * 0.17, 0, height), (-length / 2, 0, height), (thick, thick * 1.05), 15)
    neck_end = np.array([-length / 2 - u(0.1, 0.25), 0, height + u(0.15, 0.4)])
    neck = s.add(front, (-length / 2, 0, height + thick * 0.3), neck_end, (thick * 0.7, thick * 0.5), 35)
    s.add(neck, neck_end, neck_end - np.array([u(0.15, 0.25), 0, 0.05]), (thick * 0.55, thick * 0.35), 35)
    for parent, at in ((rear, length / 2), (front, -length / 2)):
        for side in (-1, 1):
            joints = [np.array([at + u(-0.03, 0.03), side * width, height * share]) for share in (0.9, 0.5, 0.16, 0.0)]
            joints[3] = joints[2] + (-0.09, 0, -height * 0.14)
            s.chain(parent, joints, (leg * 1.35, leg * 0.75), 40)
    tail = [np.array([length / 2 + step * u(0.12, 0.18), 0, height + 0.06 - 0.06 * step]) for step in range(5)]
    s.chain(rear, tail, (0.06, 0.03), 30)
    return s


def two_legged(rng: np.random.Generator) -> Skeleton:
    """A person: arms that hang down beside the trunk or stand out, legs side by side."""
    u = rng.uniform
    s = Skeleton()
    hip, width = u(0.8, 0.95), u(0.085, 0.12)
    trunk = u(0.12, 0.15)
    pelvis = s.add(-1, (0, 0, hip), (0, 0, hip + 0.17), (trunk, trunk * 0.95), 15)
    chest = s.add(pelvis, (0, 0, hip + 0.17), (0, 0, hip + 0.42), (trunk * 0.95, trunk), 20)
    neck = s.add(chest, (0, 0, hip + 0.48), (0, 0, hip + 0.62), (0.06, 0.055), 25)
    s.add(neck, (0, 0, hip + 0.65), (0, 0, hip + 0.78), (0.09, 0.1), 25)
    spread = u(10, 75)
    for side in (-1, 1):
        out = np.array([0, side * np.sin(np.radians(spread)), -np.cos(np.radians(spread))])
        shoulder = np.array([0, side * (trunk + 0.065), hip + 0.45])
        arm = [np.array([0, side * trunk * 0.6, hip + 0.45]), shoulder]
        arm += [shoulder + out * 0.29, shoulder + out * 0.56, shoulder + out * 0.72]
        s.chain(chest, arm, (0.062, 0.035), 45)
        joints = [np.array([0, side * width, hip * share]) for share in (0.95, 0.5, 0.07)]
        joints.append(joints[2] + (-0.2, 0, -0.02))
        s.chain(pelvis, joints, (width * 0.85, 0.045), 40)
    return s


def clothed(rng: np.random.Generator) -> Skeleton:
    """A person in wide trousers and sleeves."""
    u = rng.uniform
    s = Skeleton()
    hip, width, trunk = u(0.8, 0.95), u(0.1, 0.13), u(0.12, 0.16)
    pelvis = s.add(-1, (0, 0, hip), (0, 0, hip + 0.17), (trunk * 1.15, trunk), 15)
    chest = s.add(pelvis, (0, 0, hip + 0.17), (0, 0, hip + 0.42), (trunk, trunk * 1.05), 20)
    neck = s.add(chest, (0, 0, hip + 0.48), (0, 0, hip + 0.62), (0.065, 0.06), 25)
    s.add(neck, (0, 0, hip + 0.65), (0, 0, hip + 0.78), (0.1, 0.11), 25)
    spread, flare = u(15, 60), width * u(0.7, 1.0)
    for side in (-1, 1):
        out = np.array([0, side * np.sin(np.radians(spread)), -np.cos(np.radians(spread))])
        shoulder = np.array([0, side * (trunk + 0.065), hip + 0.45])
        arm = [np.array([0, side * trunk * 0.6, hip + 0.45]), shoulder]
        s.chain(chest, [*arm, *(shoulder + out * long for long in (0.29, 0.56, 0.72))], (0.07, 0.055), 45)
        top, knee, ankle = (np.array([0, side * width, hip * share]) for share in (0.95, 0.5, 0.07))
        shin = s.chain(pelvis, [top, knee, ankle], (width * 0.95, flare), 40)
        s.add(shin, ankle, ankle - np.array([0.2, 0, 0.02]), (0.06, 0.045), 30)
    return s


def octopus(rng: np.random.Generator) -> Skeleton:
    """A head and eight arms of five bones."""
    u = rng.uniform
    s = Skeleton()
    head = s.add(-1, (0, 0, 0.25), (0, 0, u(0.45, 0.6)), (0.2, u(0.2, 0.28)), 10)
    drop = u(0.1, 0.8)
    for arm in range(8):
        angle = 2 * np.pi * arm / 8 + u(-0.1, 0.1)
        out = np.array([np.cos(angle), np.sin(angle), 0])
        joints = [
            np.array([0, 0, 0.22]) + out * (0.12 + 0.17 * step) - [0, 0, drop * 0.04 * step**1.5] for step in range(6)
        ]
        s.chain(head, joints, (0.085, 0.035), 25)
    return s


def hand(rng: np.random.Generator) -> Skeleton:
    """A palm, four fingers side by side and a thumb."""
    u = rng.uniform
    s = Skeleton()
    gap = u(0.17, 0.21)
    wrist = s.add(-1, (0, 0, -0.5), (0, 0, -0.1), (0.14, 0.15), 10)
    for finger in range(4):
        across = (finger - 1.5) * gap
        palm = s.add(wrist, (across * 0.6, 0, -0.08), (across, 0, 0.35), (0.11, 0.09), 8)
        long = u(0.17, 0.23) * (1.1 if finger in (1, 2) else 0.9)
        s.chain(palm, [np.array([across, 0, 0.4 + long * k]) for k in range(4)], (0.07, 0.055), 35)
    thumb = [np.array([-0.3 - 0.13 * k, 0, 0.05 + 0.14 * k]) for k in range(3)]
    s.chain(wrist, [np.array([-0.12, 0, -0.1]), *thumb], (0.09, 0.06), 30)
    return s


def chair(rng: np.random.Generator) -> Skeleton:
    """A seat, a back and four legs, each a box that overlaps its neighbour a little."""
    u = rng.uniform
    s = Skeleton()
    width, depth, height = u(0.4, 0.6), u(0.4, 0.6), u(0.4, 0.6)
    leg = u(0.025, 0.04)
    seat = s.add(-1, (-depth / 2, 0, height), (depth / 2, 0, height), (0.03, width / 2), 5)
    s.add(
        seat,
        (depth / 2 - 0.03, 0, height + 0.01),
        (depth / 2 + u(0, 0.1), 0, height + u(0.4, 0.7)),
        (0.025, width / 2),
        25,
    )
    for x in (-1, 1):
        for y in (-1, 1):
            top = np.array([x * (depth / 2 - leg * 1.5), y * (width / 2 - leg * 1.5), height])
            s.add(seat, top, top * (1 + u(0, 0.15), 1 + u(0, 0.15), 0), (leg, leg), 20)
    return s


KINDS: dict[str, tuple[Callable[[np.random.Generator], Skeleton], Callable[[Skeleton], Surface]]] = {
    "four-legged": (four_legged, level_set),
    "two-legged": (two_legged, level_set),
    "clothed": (clothed, level_set),
    "octopus": (octopus, level_set),
    "hand": (hand, level_set),
    "chair": (chair, boxes),
}


def creature(
    kind: str, seed: int, turned: Callable[[Skeleton, np.random.Generator], Turned] = free, poses: int = 4
) -> Poses:
    """Return one of a kind, at rest and in random poses."""
    skeleton, rest, rng = _made(kind, seed)
    skin = _skin(kind, skeleton, rest)
    moved = [skeleton.pose(rest.positions, skin, turned(skeleton, rng)) for _ in range(poses)]
    return Poses(f"{kind} {seed} {turned.__name__}", rest, np.stack(moved))


def inside(
    kind: str, seed: int, turned: Callable[[Skeleton, np.random.Generator], Turned], chosen: Indices, poses: int = 4
) -> tuple[Array, Array]:
    """Return points half way from vertices to the axes of their bones: at rest (m, 3), in the poses of `creature`."""
    skeleton, rest, rng = _made(kind, seed)
    skin = _skin(kind, skeleton, rest)[chosen]
    points = rest.positions[chosen]
    for number, bone in enumerate(skin.argmax(axis=1)):
        points[number] = (points[number] + skeleton.bones[bone].nearest(points[number])) / 2
    moved_skin = skin if KINDS[kind][1] is boxes else skeleton.skin(points)
    return points, np.stack([skeleton.pose(points, moved_skin, turned(skeleton, rng)) for _ in range(poses)])


def _made(kind: str, seed: int) -> tuple[Skeleton, Surface, np.random.Generator]:
    """The skeleton, its surface, and what the poses are drawn from."""
    make, surface = KINDS[kind]
    rng = np.random.default_rng([seed, *kind.encode()])
    skeleton = make(rng)
    return skeleton, surface(skeleton), rng


def _skin(kind: str, skeleton: Skeleton, rest: Surface) -> Array:
    """How much each bone moves each vertex; each box follows its own bone."""
    if KINDS[kind][1] is not boxes:
        return skeleton.skin(rest.positions)
    count = len(skeleton.bones)
    return np.repeat(np.eye(count), len(rest.positions) // count, axis=0)
