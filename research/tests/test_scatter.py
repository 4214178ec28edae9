"""The paper's scatter."""

from __future__ import annotations

import numpy as np
import pytest
from PIL import Image

import neuralmls as nm

pytest.importorskip("matplotlib")
from neuralmls_research.scatter import scatter

LABELS = {"x_label": "error", "y_label": "distortion"}


def test_every_method_has_its_own_colour(tmp_path):
    scatter({"one": [(1.0, 2.0), (2.0, 3.0)], "other": [(3.0, 1.0)]}, tmp_path / "s.png", **LABELS)
    page = np.asarray(Image.open(tmp_path / "s.png").convert("RGB")).reshape(-1, 3).astype(int)
    colourful = page[np.ptp(page, axis=1) > 100]
    assert len(np.unique(colourful.argmax(axis=1))) == 2


def test_values_of_very_different_size_and_zeros_are_drawn(tmp_path):
    scatter({"one": [(1e-6, 0.0)], "other": [(1.0, 5.0)], "nothing": [(np.nan, 1.0)]}, tmp_path / "s.png", **LABELS)
    assert np.asarray(Image.open(tmp_path / "s.png")).std() > 1


def test_nothing_to_draw_is_refused(tmp_path):
    with pytest.raises(nm.ArgumentError, match="at least one finite point"):
        scatter({"one": [(np.inf, 1.0)]}, tmp_path / "s.png", **LABELS)
    with pytest.raises(nm.FileError, match=r"ends in \.png"):
        scatter({"one": [(1.0, 1.0)]}, tmp_path / "s.jpg", **LABELS)
    assert not list(tmp_path.iterdir())
