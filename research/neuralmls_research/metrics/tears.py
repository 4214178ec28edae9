"""What comes apart: parts that touched at rest, and triangles that are stretched by far more than was asked for."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from neuralmls.plugin import as_number, as_points, as_triangles
from neuralmls_research.baselines.checks import library
from neuralmls_research.metrics.strains import singular_values
from neuralmls_research.metrics.triangles import Array, Indices, as_surface, normals, places

# Lengths in longest sides of the box. Parts touch within this: the measure's own word, whatever a method links.
TOUCH = 0.015
# An opening that is no wider is not counted: about the distance of the samples from each other, and hardly seen.
UNSEEN = 0.01
SAMPLES = 40_000
# Steps of a sequence that fills the square evenly (Roberts 2018, "The unreasonable effectiveness of quasirandom
# sequences"): one divided by the plastic number, and by its square.
EVENLY = np.array([0.7548776662466927, 0.5698402909980532])


@dataclass(frozen=True)
class Tears:
    """How far the parts of a shape come apart where they touched.

    Attributes
    ----------
    opened : float
        The part, 0 to 1, of the surface near contacts that is farther than `UNSEEN` from where it touched; 0 without
        contacts.
    widest : float
        The greatest opening, in longest sides of the box at rest; 0 where nothing touches.
    """

    opened: float
    widest: float


class Contacts:
    """Where the parts of a surface touch at rest, found once for any number of deformations.

    A part is what is connected by edges, vertices in one place taken as one. Places that are spread evenly over the
    surface touch another part if they are within `TOUCH` of it.

    Parameters
    ----------
    x : (n, 3), vertices at rest, in any units
    faces : (f, 3) integers

    Raises
    ------
    ArgumentError
        They are no such arrays.
    NeuralMLSError
        SciPy is not installed.

    Examples
    --------
    >>> sheet = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    >>> two = np.concatenate([sheet, sheet + [0, 0, 0.005]])
    >>> contacts = Contacts(two, [[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]])
    >>> lifted = two + np.repeat([[0, 0, 0], [0, 0, 0.1]], 4, axis=0)
    >>> found = contacts.opened(lifted)
    >>> found.opened, round(found.widest, 2)
    (1.0, 0.1)
    """

    def __init__(self, x: ArrayLike, faces: ArrayLike) -> None:
        rest = as_points("x", x, 3)
        triangles = as_triangles(faces, len(rest))
        self._side = float(np.ptp(rest, axis=0).max(initial=0.0)) if len(rest) else 0.0
        self._corners, self._shares, part = _samples(rest, triangles)
        at = self._places(rest)
        # A pair of a place and another part that it touches, by parts.
        self._touching: list[tuple[Indices, Indices, Array]] = []
        for number in range(int(part.max(initial=-1)) + 1):
            own, others = np.flatnonzero(part == number), np.flatnonzero(part != number)
            if not len(own):
                continue
            reach = TOUCH * self._side
            near = ((at[others] >= at[own].min(axis=0) - reach) & (at[others] <= at[own].max(axis=0) + reach)).all(
                axis=1
            )
            others = others[near]
            away = _nearest(at[own], at[others], reach)
            self._touching.append((own, others[away < reach], away[away < reach]))

    @property
    def count(self) -> int:
        """How many places touch another part, once for each."""
        return sum(len(others) for _, others, _ in self._touching)

    def opened(self, y: ArrayLike) -> Tears:
        """Return how far the parts come apart where the vertices go to `y` (n, 3)."""
        at = self._places(as_points("y", y, 3))
        wider = [_nearest(at[own], at[others]) - away for own, others, away in self._touching if len(others)]
        if not wider or not self._side:
            return Tears(0.0, 0.0)
        openings = np.concatenate(wider) / self._side
        return Tears(float((openings > UNSEEN).mean()), max(float(openings.max()), 0.0))

    def _places(self, x: Array) -> Array:
        at: Array = (x[self._corners] * self._shares[:, :, None]).sum(axis=1)
        return at


def overstretched(x: ArrayLike, y: ArrayLike, faces: ArrayLike, limit: float) -> float:
    """Return the part, 0 to 1, of a surface whose triangles are stretched by more than a limit in some direction.

    By the mean of a triangle's area before and after: a needle that becomes long counts, and a collapsed triangle too.

    Parameters
    ----------
    limit : float > 0
        The greatest singular value that is not too much.

    Raises
    ------
    ArgumentError
        The arrays are no such arrays, or do not fit each other; the limit is not above 0.

    Examples
    --------
    >>> square = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    >>> overstretched(square, square * [3, 1, 1], [[0, 1, 2], [0, 2, 3]], 2)
    1.0
    """
    before, after, triangles = as_surface(x, y, faces)
    stretch = singular_values(before, after, triangles)[:, 0]
    areas = [np.linalg.norm(normals(points, triangles), axis=1) for points in (before, after)]
    area = np.where(np.isfinite(stretch), sum(areas), 0.0)
    return float(area[stretch > as_number("limit", limit, 0)].sum() / area.sum()) if area.sum() > 0 else 0.0


def parts(x: Array, faces: Indices) -> Indices:
    """The number of each triangle's connected part, vertices in one place taken as one, (f,)."""
    corners = places(x)[faces]
    sides = corners[:, [0, 1, 1, 2]].reshape(-1, 2)
    count = int(corners.max(initial=-1)) + 1
    graph = library("scipy.sparse").coo_matrix((np.ones(len(sides)), sides.T), shape=(count, count))
    _, number = library("scipy.sparse.csgraph").connected_components(graph, directed=False)
    _, of_triangles = np.unique(number[corners[:, 0]], return_inverse=True)
    return np.asarray(of_triangles.reshape(-1), dtype=np.int64)


def _samples(x: Array, faces: Indices) -> tuple[Indices, Array, Indices]:
    """Places spread evenly: the corners of their triangles, the shares of these (k, 3), and their parts."""
    areas = np.cumsum(np.linalg.norm(normals(x, faces), axis=1))
    if not len(areas) or not areas[-1] > 0:
        return np.empty((0, 3), dtype=np.int64), np.empty((0, 3)), np.empty(0, dtype=np.int64)
    triangle = np.searchsorted(areas, (np.arange(SAMPLES) + 0.5) / SAMPLES * areas[-1])
    u, v = (np.arange(1, SAMPLES + 1)[:, None] * EVENLY % 1.0).T
    outside = u + v > 1
    u, v = np.where(outside, 1 - u, u), np.where(outside, 1 - v, v)
    return faces[triangle], np.stack([1 - u - v, u, v], axis=1), parts(x, faces)[triangle]


def _nearest(of: Array, to: Array, reach: float = np.inf) -> Array:
    """How far the nearest of some points is from each of others; infinite beyond a reach."""
    away: Array = library("scipy.spatial").cKDTree(of).query(to, distance_upper_bound=reach)[0]
    return away
