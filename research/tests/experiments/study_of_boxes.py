"""A study that is quick to make: two boxes, two and three methods, small pictures."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from numpy.typing import ArrayLike, NDArray

import neuralmls as nm
from neuralmls.errors import NotApplicable
from neuralmls_research.experiments.methods import METHODS, Geometry, neural, of_shapes
from neuralmls_research.experiments.study.build import Study, build
from neuralmls_research.experiments.study.cases import Case

BOX = """\
v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1
f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8
"""
CORNERS = [[-1.0, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, 1]]


def _only_cars(shape: Geometry, p: ArrayLike, q: ArrayLike) -> NDArray[np.float64]:
    if np.ptp(shape.positions, axis=0)[0] < 3:
        raise NotApplicable("this is no car")
    return shape.positions + np.asarray(q)[0] - np.asarray(p)[0]


METHODS_OF_BOXES = {
    "neural": neural(width=32, steps=5),
    "classic": METHODS["classic"],
    "shift": of_shapes("shift", _only_cars),
}


def cases_of_boxes(folder: Path) -> list[Case]:
    """Return four cases: a chair, which is a cube, and a car, which is a long one, with two displacements each."""
    found = []
    for category, stretch in (("chair", 1.0), ("car", 2.0)):
        path = folder / f"{category}.obj"
        path.write_text(BOX.replace("v 1 ", f"v {2 * stretch - 1} "))
        shape = nm.read(path)
        sources = np.array(CORNERS) * [stretch, 1, 1] + [stretch - 1, 0, 0]
        for name, offset in (("up", [0, 0.5, 0]), ("out", [0.4, 0, 0.4])):
            points = nm.ControlPoints(sources).moved({"p3": offset})
            found.append(Case(category, f"box {category}", name, "made by the tests", shape, points))
    return found


def make_study_of_boxes() -> Study:
    with TemporaryDirectory() as folder:
        return build(cases_of_boxes(Path(folder)), methods=METHODS_OF_BOXES, kpd={}, question="best", height=60)


@cache
def study_of_boxes() -> Study:
    """The study, made once for all tests."""
    return make_study_of_boxes()
