"""The paper's scatter."""

from __future__ import annotations

import numpy as np
import pytest
from PIL import Image

import neuralmls as nm

pytest.importorskip("matplotlib")
from neuralmls_research.scatter import Panel, scatter


def panel(points):
    return Panel(points, "error", "distortion")


def test_every_method_has_its_own_colour(tmp_path):
    scatter([[panel({"one": [(1.0, 2.0), (2.0, 3.0)], "other": [(3.0, 1.0)]})]], tmp_path / "s.png")
    page = np.asarray(Image.open(tmp_path / "s.png").convert("RGB")).reshape(-1, 3).astype(int)
    colourful = page[np.ptp(page, axis=1) > 100]
    assert len(np.unique(colourful.argmax(axis=1))) == 2


def test_a_method_looks_the_same_in_every_scatter(tmp_path):
    lone = [[panel({"other": [(3.0, 1.0)]})]]
    both = [[panel({"one": [], "other": [(3.0, 1.0)]}), panel({"one": [(1.0, 2.0)]})]]
    scatter(lone, tmp_path / "lone.png")
    scatter(both, tmp_path / "both.png")
    colours = []
    for name in ("lone", "both"):
        page = np.asarray(Image.open(tmp_path / f"{name}.png").convert("RGB")).reshape(-1, 3).astype(int)
        colourful = page[np.ptp(page, axis=1) > 100]
        colours.append(sorted(set(colourful.argmax(axis=1))))
    assert colours == [[2], [0, 2]]  # blue; and orange, which is the second method's, beside a blue one


def test_values_of_very_different_size_and_zeros_are_drawn(tmp_path):
    scatter([[panel({"one": [(1e-6, 0.0)], "other": [(1.0, 5.0)], "nothing": [(np.nan, 1.0)]})]], tmp_path / "s.png")
    assert np.asarray(Image.open(tmp_path / "s.png")).std() > 1


def test_nothing_to_draw_is_refused(tmp_path):
    with pytest.raises(nm.ArgumentError, match="at least one finite point"):
        scatter([[panel({"one": [(np.inf, 1.0)]})]], tmp_path / "s.png")
    with pytest.raises(nm.FileError, match=r"ends in \.png"):
        scatter([[panel({"one": [(1.0, 1.0)]})]], tmp_path / "s.jpg")
    assert not list(tmp_path.iterdir())
