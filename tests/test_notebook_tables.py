"""What a notebook shows of an object: a small table, in which nothing that a file says is markup."""

from __future__ import annotations

import numpy as np
import pytest

import neuralmls as nm
from neuralmls.tables import MOST_ROWS

EVIL = "<script>alert('x')</script>\"&"


@pytest.fixture
def points() -> nm.ControlPoints:
    return nm.ControlPoints([[0.0, 0, 0], [0, 1, 0]], names=["foot", EVIL]).moved({"foot": [0.5, 0, 0]})


def test_control_points_show_where_they_are_and_go(points):
    shown = points._repr_html_()
    assert "<td>foot</td><td>0, 0, 0</td><td>0.5, 0, 0</td><td>0.5</td>" in shown
    assert "orientation" not in shown
    turned = points.oriented({"foot": nm.Orientation((0, 1, 0), degrees=40)})
    assert "<th>orientation</th>" in turned._repr_html_()
    assert str(turned.orientations[0]) in turned._repr_html_()
    weighed = nm.ControlPoints([[0.0, 0], [1, 0]], weights=[1, 0.25])
    assert "<th>weight</th>" in weighed._repr_html_()
    assert "<td>0.25</td>" in weighed._repr_html_()


def test_sessions_and_maps_show_their_settings(points):
    session = nm.Session(points, weights="inverse-distance", temperature=0.5, alpha=2)
    shown = session._repr_html_()
    assert "<th>temperature</th><td>0.5</td>" in shown
    assert "inverse-distance (alpha 2" in shown
    assert "that of the shapes of fit" in shown
    assert points._repr_html_() in shown
    fitted = nm.Session(points, steps=3, width=8).fit([[0.0, 0, 0], [1, 2, 3]])._repr_html_()
    assert "<th>frame</th><td>[0.0, 0.0, 0.0] to [1.0, 2.0, 3.0]</td>" in fitted
    assert "<th>trained</th><td>3 steps, mean cross-entropy " in fitted


def test_shapes_show_what_is_in_their_file(tmp_path):
    file = tmp_path / "<b>tri.obj"
    file.write_text(f"g {EVIL.replace(' ', '')}\nv 0 0 0\nv 2 0 0\nv 0 1 0\nf 1 2 3\n")
    shown = nm.read(file)._repr_html_()
    assert "&lt;b&gt;tri.obj: OBJ" in shown
    assert "<th>vertices</th><td>3</td>" in shown
    assert "<th>triangles</th><td>1</td>" in shown
    assert "<th>size</th><td>2 x 1 x 0</td>" in shown
    assert "<b>" not in shown
    assert "<script" not in shown


def test_names_are_text(points):
    for shown in (points._repr_html_(), nm.Session(points)._repr_html_()):
        assert "<script" not in shown
        assert "&lt;script&gt;alert(&#x27;x&#x27;)&lt;/script&gt;&quot;&amp;" in shown


def test_long_lists_are_cut_short():
    many = nm.ControlPoints(np.arange(1000.0)[:, None])
    shown = many._repr_html_()
    assert f"and {1000 - MOST_ROWS} more" in shown
    assert len(shown) < 4000
