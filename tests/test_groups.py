"""Groups that move as one piece, and control points that are locked."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import neuralmls as nm

# A bar along x, held at one end, with a plate of four control points at the other.
SOURCES = np.array([[-2, 0, 0], [-2, 0.5, 0.5], [2, 0, 0], [2, 1, 0], [2, 0, 1], [2, 1, 1]], np.float64)
NAMES = ["end", "side", "a", "b", "c", "d"]
PLATE = ["a", "b", "c", "d"]
QUARTER = nm.Orientation((0, 0, 1), 90)


def plate(**options: object) -> nm.ControlPoints:
    return nm.ControlPoints(SOURCES, names=NAMES, **options).grouped(PLATE, "plate")  # type: ignore[arg-type]


def fitted(points: nm.ControlPoints, **settings: object) -> nm.Map:
    return nm.Session(points, weights="inverse-distance", alpha=2, **settings).fit()  # type: ignore[arg-type]


def test_a_group_moves_as_one_piece_and_says_how_far_its_targets_were_from_one() -> None:
    q = SOURCES.copy()
    q[3] += [0, 0.4, 0]
    map = fitted(plate(targets=q))
    y = map.at(SOURCES[2:])
    lengths = [
        np.linalg.norm(y[i] - y[k]) - np.linalg.norm(SOURCES[2 + i] - SOURCES[2 + k])
        for i in range(4)
        for k in range(i)
    ]
    assert np.abs(lengths).max() < 1e-6
    (warning,) = map.report().warnings
    assert "its targets are no rigid motion of it" in warning
    assert "'plate' by up to 0.2" in warning
    assert map.session.points.targets.tolist() == q.tolist()


def test_what_is_around_a_group_turns_with_it() -> None:
    points = plate().oriented({"plate": QUARTER})
    assert not points.is_oriented  # its targets turn
    centre = SOURCES[2:].mean(axis=0)
    near = np.array([[2, 1.3, 1.3], [1.7, 0, 0], [1.5, 0.5, 0.5]])  # beside it, and on the side of the end that stays
    turned = (near - centre) @ QUARTER.matrix.T + centre
    as_one, each = (
        np.linalg.norm(fitted(by).at(near) - turned, axis=1) for by in (points, points.grouped(PLATE, None))
    )
    assert as_one.max() < 0.03
    assert (2 * as_one < each).all()


def test_a_locked_control_point_stays_and_holds() -> None:
    q = SOURCES + np.array([0, 0.5, 0])
    points = nm.ControlPoints(SOURCES, q, NAMES).oriented({"d": QUARTER})
    map = fitted(points.with_locked(["end", "d"]))
    report = map.report()
    assert np.abs(map.at(SOURCES[[0, 5]]) - SOURCES[[0, 5]]).max() < 1e-6
    assert report.moved[[0, 5]].tolist() == [0, 0]
    assert report.orientations[5] is None
    assert "the targets and rotations of 'end' and 'd' are not used" in report.warnings[0]
    assert points.with_locked(["a"]).with_locked([]).locked.tolist() == [False] * 6


def test_a_session_without_groups_and_locks_is_as_it_was() -> None:
    points = plate().moved({"plate": [0, 0.3, 0]})
    free = points.grouped(NAMES, None)
    assert free.groups == (None,) * 6
    plain = nm.ControlPoints(SOURCES, points.targets, NAMES)
    x = np.random.default_rng(0).normal(size=(50, 3))
    assert fitted(free).at(x).tolist() == fitted(plain).at(x).tolist()
    assert fitted(points).at(x).tolist() != fitted(plain).at(x).tolist()


def test_similarity_scales_a_group() -> None:
    points = plate().oriented({"plate": nm.Orientation(scale=1.5)})
    assert fitted(points, transform="similarity").report().warnings == ()
    assert len(fitted(points).report().warnings) == 1


def test_groups_and_locks_are_written_and_read(tmp_path: Path) -> None:
    points = plate(locked=[True, *[False] * 5])
    points.write(tmp_path / "held.json")
    again = nm.ControlPoints.read(tmp_path / "held.json")
    assert again.groups == (None, None, *["plate"] * 4) == points.groups
    assert again.locked.tolist() == points.locked.tolist() == [True, *[False] * 5]
    written = json.loads((tmp_path / "held.json").read_text(encoding="utf-8"))["control_points"]
    assert (written[0]["locked"], written[2]["group"]) == (True, "plate")
    with pytest.raises(nm.FileError, match="a CSV file holds no groups"):
        points.write(tmp_path / "held.csv")
    with pytest.raises(nm.FileError, match="a CSV file holds no locks"):
        points.grouped(PLATE, None).write(tmp_path / "held.csv")


@pytest.mark.parametrize(
    ("options", "says"),
    [
        ({"groups": ["seat"]}, "expected a group or None for each of 6 control points, found 1"),
        ({"groups": [7, *[None] * 5]}, "expected the group of control point 1 to be a text, found 7"),
        ({"groups": [" ", *[None] * 5]}, "the group of 'end' has no name"),
        ({"groups": ["\ud800", *[None] * 5]}, "the group of control point 1 has half of a surrogate pair in it"),
        ({"locked": [True]}, "expected true or false for each of 6 control points, found 1"),
        ({"locked": [2] * 6}, "locked: expected true or false for each control point"),
    ],
)
def test_what_is_no_group_and_no_lock_is_refused(options: dict[str, object], says: str) -> None:
    with pytest.raises(nm.ControlPointError, match=says):
        nm.ControlPoints(SOURCES, names=NAMES, **options)  # type: ignore[arg-type]


def test_names_that_are_not_there_are_refused() -> None:
    for call in (lambda: plate().grouped(["e"], "plate"), lambda: plate().with_locked(["e"])):
        with pytest.raises(nm.ArgumentError, match="there is no control point 'e'"):
            call()
    with pytest.raises(nm.ArgumentError, match="names: expected a list of names of control points, found 'abc'"):
        plate().grouped("abc", "plate")
