"""The baselines on real shapes: true poses as QUALITY.md measured them, and soups, which are refused in words.

`pytest tests/baselines/test_real_shapes.py -s` prints the figures.
"""

from __future__ import annotations

import numpy as np
import pytest

import neuralmls as nm
from neuralmls.errors import NotApplicable
from neuralmls_research import baselines

SOUPS = ["shapenet/ShapeNetPlane1/model.obj", "shapenet/ShapeNetPlane2/model.obj", "shapenet/ShapeNetChair1/model.obj"]
# Mean distance to the true pose in % of the rest box's diagonal; 12 control points, or 40.
POSES = [
    ("rbf", "cat-poses", 12, 3.68),
    ("rbf", "cat-poses", 40, 1.41),
    ("rbf", "lion-poses", 12, 3.92),
    ("rbf", "lion-poses", 40, 1.44),
    ("rbf", "samba", 12, 2.87),
    ("rbf", "samba", 40, 1.34),
    ("arap", "lion-poses", 12, 3.60),
    ("arap", "lion-poses", 40, 1.58),
]


def farthest(x: np.ndarray, count: int) -> list[int]:
    """Farthest-point sampling of the vertices, from the one farthest from their mean."""
    away = np.full(len(x), np.inf)
    chosen = [int(((x - x.mean(axis=0)) ** 2).sum(axis=1).argmax())]
    while len(chosen) < count:
        away = np.minimum(away, ((x - x[chosen[-1]]) ** 2).sum(axis=1))
        chosen.append(int(away.argmax()))
    return chosen


@pytest.mark.parametrize(("name", "animal", "count", "measured"), POSES)
def test_true_poses_are_met_as_well_as_measured_before(name, animal, count, measured, data, shape):
    if not (data / "poses").is_dir():
        pytest.skip("no poses in the test data")
    given = np.load(data / "poses" / f"{animal}.npz")
    rest = shape(given["rest"], given["faces"])
    diagonal = np.linalg.norm(np.ptp(rest.positions, axis=0))
    held = farthest(rest.positions, count)
    errors = []
    for pose in given["poses"][np.linspace(0, len(given["poses"]) - 1, 6).astype(int)].astype(np.float64):
        y = baselines.get(name)(rest, rest.positions[held], pose[held])
        errors.append(100 * np.linalg.norm(y - pose, axis=1).mean() / diagonal)
    print(f"{name} {animal} {count}: {np.mean(errors):.2f}, before {measured}")
    assert np.mean(errors) == pytest.approx(measured, rel=0.05)


@pytest.mark.parametrize("name", ["arap", "biharmonic"])
@pytest.mark.parametrize("path", SOUPS)
def test_soups_are_refused_in_words_by_solvers_for_surfaces(name, path, data):
    soup = nm.read(data / path)
    p = nm.farthest_points(soup.positions, soup.faces, 8)
    with pytest.raises(NotApplicable) as caught:
        baselines.get(name)(soup, p, p + 0.1)
    print(f"{path}: {caught.value}")
    assert len(str(caught.value)) < 200


@pytest.mark.parametrize("path", SOUPS)
def test_soups_are_deformed_by_what_needs_no_surface(path, data):
    soup = nm.read(data / path)
    p = nm.farthest_points(soup.positions, soup.faces, 8)
    for name in ("classic", "rbf"):
        assert np.isfinite(baselines.get(name)(soup, p, p * 1.1)).all()
