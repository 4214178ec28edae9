"""Maps that fold nothing: what they keep, what they need, and that every face has them."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import neuralmls as nm
from neuralmls.cli import main
from neuralmls.samples import make
from neuralmls.samples.sample import write_obj

CHAIR = make("chair")
X, FACES = CHAIR.vertices, CHAIR.triangles
SIDE = float(np.ptp(X, axis=0).max())
P = nm.farthest_points(X, FACES, count=12)


def dragged(part: float, seed: int = 1) -> nm.ControlPoints:
    """Every control point moved at random."""
    return nm.ControlPoints(P, P + part * SIDE * np.random.default_rng(seed).normal(size=P.shape))


def fitted(points: nm.ControlPoints, weights: str = "inverse-distance", **said: object) -> nm.Map:
    return nm.Session(points, weights=weights, **{"no_folds": True, **said}).fit(X, faces=FACES)  # type: ignore[arg-type]


def folded(map: nm.Map) -> float:
    """The part of other places on the shape that is turned inside out."""
    rng = np.random.default_rng(7)
    a, b, c = (X[FACES[:, k]] for k in range(3))
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    which = rng.choice(len(FACES), 4000, p=area / area.sum())
    s, t = np.sort(rng.random((2, 4000, 1)), axis=0)
    places = a[which] + s * (b - a)[which] + (t - s) * (c - a)[which]
    return float((np.linalg.det(map.jacobian(places)) <= 0).mean())


@pytest.mark.parametrize("weights", ["neural", "inverse-distance"])
def test_a_drag_of_a_fifth_of_the_side_folds_nothing(weights):
    points = dragged(0.2)
    one = fitted(points, weights, no_folds=False)
    assert folded(one) > 0.005
    map = fitted(points, weights)
    report = map.report()
    assert report.steps > 1
    assert report.folded == 0
    assert report.least is not None
    assert report.least > 0
    assert folded(map) == 0
    assert report.distance_to_target.max() < 1e-6 * SIDE
    assert report.warnings == ()
    assert report.handles == "exact"
    assert fitted(points, weights).at(X).tobytes() == map.at(X).tobytes()
    assert one.report().steps == 1
    assert one.report().least is None


@pytest.mark.parametrize("weights", ["neural", "inverse-distance"])
def test_what_does_not_fold_stays_as_it_was_to_the_bit(weights):
    points = dragged(0.03)
    map = fitted(points, weights)
    assert map.report().steps == 1
    assert map.at(X).tobytes() == fitted(points, weights, no_folds=False).at(X).tobytes()


def test_steps_are_undone():
    map = fitted(dragged(0.2))
    y = map.at(X)
    assert np.abs(map.inverse(y) - X).max() < 1e-7  # logits of points are of single precision
    far = nm.ControlPoints(P, P + 10 * np.ones(3))
    assert fitted(far).report().steps == 1


def test_a_saved_map_is_the_same(tmp_path):
    map = fitted(dragged(0.2), "neural")
    map.save(tmp_path / "chair.map")
    again = nm.Map.load(tmp_path / "chair.map")
    assert again.at(X).tobytes() == map.at(X).tobytes()
    assert again.report().steps == map.report().steps
    moved = again.moved(dragged(0.2, seed=2))
    assert moved.at(X).tobytes() == fitted(dragged(0.2, seed=2), "neural").at(X).tobytes()


def test_it_needs_a_shape_and_weights_that_can_be_fitted_again():
    with pytest.raises(nm.ArgumentError, match="no_folds needs at least one shape"):
        nm.Session(dragged(0.2), no_folds=True).fit()
    with pytest.raises(nm.ArgumentError, match="it needs neural or inverse-distance weights, found shape-aware ones"):
        nm.Session(dragged(0.2), weights="shape-aware", no_folds=True)
    with pytest.raises(nm.ArgumentError, match="cannot be had with relax, found relax 1"):
        nm.Session(dragged(0.2), relax=1.0, no_folds=True)


def test_a_fit_tells_how_far_it_is_and_can_be_stopped():
    told: list[float] = []
    session = nm.Session(dragged(0.2), weights="inverse-distance", no_folds=True)
    session.fit(X, faces=FACES, progress=told.append)
    assert told == sorted(told)
    assert told[-1] == 1
    assert len(told) > 5

    def stop(done: float) -> None:
        if done > 0.5:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        session.fit(X, faces=FACES, progress=stop)


def test_the_command_line_says_how_many_steps(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    write_obj(CHAIR, Path("chair.obj"))
    nm.Session(dragged(0.2), weights="inverse-distance").write("points.json")
    assert main(["deform", "chair.obj", "--points", "points.json", "-o", "bent.obj", "--no-folds", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["no_folds"] is True
    assert told["steps"] > 1
    assert told["folded"] == 0 < told["least"]
    assert main(["deform", "chair.obj", "--points", "points.json", "-o", "again.obj", "--no-folds"]) == 0
    assert f"{told['steps']} steps, least det J" in capsys.readouterr().out
    assert main(["fit", "chair.obj", "--points", "points.json", "-o", "chair.map", "--no-folds"]) == 0
    assert main(["deform", "chair.obj", "--map", "chair.map", "-o", "mapped.obj", "-q"]) == 0
    assert Path("mapped.obj").read_bytes() == Path("bent.obj").read_bytes()
    assert main(["deform", "chair.obj", "--map", "chair.map", "-o", "one.obj", "-q", "--one-step"]) == 0
    assert Path("one.obj").read_bytes() != Path("bent.obj").read_bytes()
