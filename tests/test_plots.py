"""`plot()`: what it draws, what heat is, and one sentence where it cannot be."""

from __future__ import annotations

import io
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

pytest.importorskip("pyvista", reason="the extra 'figures' is not installed")

from PIL import Image

import neuralmls as nm
from neuralmls.figures import plots
from neuralmls.figures.picture import Picture

TETRAHEDRON = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
POINTS = nm.ControlPoints([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]], names=["foot", "side", "top"]).moved(
    {"top": [0, 0.5, 0]}
)


@pytest.fixture
def shape(tmp_path: Path) -> nm.Shape:
    (tmp_path / "tetrahedron.obj").write_text(TETRAHEDRON)
    return nm.read(tmp_path / "tetrahedron.obj")


@pytest.fixture
def map(shape: nm.Shape) -> nm.Map:
    return nm.Session(POINTS, weights="inverse-distance").fit(shape)


@pytest.fixture
def drawn(monkeypatch: pytest.MonkeyPatch) -> list[dict]:
    """What is asked to be drawn, in place of drawing it."""
    calls: list[dict] = []

    def draw(panels, **rest):
        calls.append({"panels": panels, **rest})
        return Picture(b"")

    monkeypatch.setattr(plots, "draw", draw)
    return calls


def pixels(picture: Picture) -> NDArray[np.int64]:
    return np.asarray(Image.open(io.BytesIO(picture._repr_png_())).convert("RGB")).astype(np.int64)


def test_a_shape_and_a_map_are_pictures_that_a_notebook_shows_and_that_can_be_written(shape, map, tmp_path):
    alone, both = shape.plot(width=160), map.plot(shape, heat="top", width=240)
    for picture, width in ((alone, 160), (both, 240)):
        assert pixels(picture).shape[1] == width
        assert pixels(picture).std() > 5
    both.write(tmp_path / "both.png")
    assert (tmp_path / "both.png").read_bytes() == both.png
    with pytest.raises(nm.FileError, match=r"both\.jpg: expected a name that ends in \.png"):
        both.write(tmp_path / "both.jpg")


def test_a_map_is_drawn_at_rest_and_deformed(shape, map, drawn):
    map.plot(shape)
    [call] = drawn
    before, after = call["panels"]
    np.testing.assert_array_equal(before.positions, shape.positions)
    np.testing.assert_array_equal(after.positions, map.deform(shape))
    np.testing.assert_array_equal(after.faces, shape.faces)
    assert before.weights is None
    assert call["control_points"].names == POINTS.names


@pytest.mark.parametrize("heat", ["top", 2])
def test_the_heat_of_a_control_point_is_its_weight(shape, map, drawn, heat):
    cooler = map.with_session(map.session.replace(temperature=0.5))
    cooler.plot(shape, heat=heat)
    weights = nm.softmax(map.weights.logits(shape.positions), 0.5)
    for panel in drawn[0]["panels"]:
        np.testing.assert_array_equal(panel.weights, weights[:, 2])
    assert drawn[0]["panels"][0].title == "at rest, weight of top"


def test_the_heat_of_displacement_is_how_far_points_move(shape, map, drawn):
    map.plot(shape, heat="displacement")
    far = np.linalg.norm(map.at(shape.positions) - shape.positions, axis=1)
    np.testing.assert_allclose(drawn[0]["panels"][0].weights, far / far.max())
    assert drawn[0]["scale"] == ("moved  0", f"{far.max():.3g}")


def test_an_unmoved_map_has_no_displacement(shape, drawn):
    unmoved = nm.Session(nm.ControlPoints(POINTS.sources), weights="inverse-distance").fit(shape)
    unmoved.plot(shape, heat="displacement")
    assert not drawn[0]["panels"][0].weights.any()


def test_a_control_point_called_displacement_is_one(shape, drawn):
    points = nm.ControlPoints(POINTS.sources, names=["displacement", "b", "c"])
    nm.Session(points, weights="inverse-distance").fit(shape).plot(shape, heat="displacement")
    assert drawn[0]["panels"][0].title == "at rest, weight of displacement"


def test_what_is_flat_is_seen_from_the_front_unless_told_otherwise(drawn):
    flat = nm.Session(nm.ControlPoints([[0.0, 0], [1, 0]]), weights="inverse-distance").fit()
    flat.plot([[0.0, 0], [1, 1]])
    flat.plot([[0.0, 0], [1, 1]], azimuth=20)
    assert (drawn[0]["azimuth"], drawn[0]["elevation"]) == (0, 0)
    assert (drawn[1]["azimuth"], drawn[1]["elevation"]) == (20, 0)
    flat.plot([[0.0, 0], [1, 1], [0, 1]], [[0, 1, 2]])
    assert drawn[0]["panels"][0].faces is None
    assert drawn[2]["panels"][1].faces == [[0, 1, 2]]


@pytest.mark.parametrize(
    ("heat", "words"),
    [
        ("tops", "heat: there is no control point 'tops'; the nearest name is 'top'"),
        (3, "heat: expected a control point's name, or its number from 0 to 2, found 3"),
        (-1, "found -1"),
        (0.5, r"found 0\.5"),
    ],
)
def test_a_heat_that_is_none_is_refused(shape, map, heat, words):
    with pytest.raises(nm.ArgumentError, match=words):
        map.plot(shape, heat=heat)


def test_without_pyvista_the_extra_is_named(shape, map, monkeypatch):
    monkeypatch.setitem(sys.modules, "pyvista", None)
    for plot in (shape.plot, lambda: map.plot(shape)):
        with pytest.raises(nm.NeuralMLSError, match=r"pip install 'neuralmls\[figures\]' \(in a checkout: "):
            plot()


def test_only_a_picture_imports_what_draws_it(tmp_path):
    script = (
        "import sys, neuralmls as nm\n"
        "open('cloud.xyz', 'w').write('0 0 0\\n1 2 3\\n')\n"
        "shape, points = nm.read('cloud.xyz'), nm.ControlPoints([[0.0, 0, 0]])\n"
        "shape._repr_html_(), nm.Session(points, weights='inverse-distance').fit(shape)._repr_html_()\n"
        "sys.exit(', '.join({'pyvista', 'PIL', 'matplotlib', 'neuralmls.figures'} & set(sys.modules)))\n"
    )
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    ran = subprocess.run([sys.executable, "-c", script], cwd=tmp_path, env=environment, capture_output=True, text=True)
    assert ran.stderr.strip() == ""
