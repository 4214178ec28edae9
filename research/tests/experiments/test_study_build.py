"""How a study is built: it goes on where it was stopped, and takes the keypoints of KeypointDeformer."""

from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("pyvista", reason="the extra 'figures' is not installed")

from neuralmls_research.baselines.kpd import KeypointDeformer
from neuralmls_research.experiments.study.build import build
from neuralmls_research.experiments.study.cases import COUNT, cases
from neuralmls_research.experiments.study.store import Store
from research.tests.experiments.study_of_boxes import METHODS_OF_BOXES, cases_of_boxes, study_of_boxes


def test_a_build_that_was_stopped_goes_on_and_makes_the_same_page(tmp_path):
    found = cases_of_boxes(tmp_path)
    made = []

    def stop(done: int) -> None:
        made.append(done)
        if done == 3:
            raise KeyboardInterrupt

    options = {"methods": METHODS_OF_BOXES, "kpd": {}, "question": "best", "height": 60}
    store = Store(tmp_path / "unfinished", "these methods")
    with pytest.raises(KeyboardInterrupt):
        build(found, store=store, progress=stop, **options)
    assert made == [1, 2, 3]
    done = build(found, store=store, **options)
    assert (done.kept, done.page) == (3, study_of_boxes().page)
    store.clear()
    assert not store.folder.exists()


def test_a_question_of_another_shape_or_that_is_broken_is_made_again(tmp_path):
    case, other = cases_of_boxes(tmp_path)[:2]
    store = Store(tmp_path / "unfinished", "these methods")
    assert store.get(1, case) is None
    store.put(1, case, {"methods": ["neural"]})
    assert store.get(1, case) == {"methods": ["neural"]}
    assert store.get(1, other) is None
    assert Store(store.folder, "other methods").get(1, case) is None
    (store.folder / "q1.json").write_text('{"made_of": ')
    assert store.get(1, case) is None


def test_control_points_are_keypoints_where_there_is_a_network(data, golden):
    networks = {
        category: KeypointDeformer.read(golden / "kpd" / "weights" / f"kpd_{category}_8kpt.safetensors")
        for category in ("airplane", "car")
    }
    found = list(cases(data, networks))
    assert len(found) == COUNT
    assert [case.name for case in found if case.category == "car"][::3] == ["beetle", "smart", "sedan"]
    for case in found:
        if case.category in networks:
            distance = np.abs(networks[case.category].keypoints(case.shape) - case.control_points.sources).max()
            assert distance < 1e-3 * np.ptp(case.shape.positions, axis=0).max()
            assert (case.control_points.sources != case.control_points.targets).any()
    own = [case for case in cases(None, networks) if case.category == "car"]
    assert {case.origin for case in own} == {"made by this package"}
    for case in own:  # which part each keypoint is
        at = dict(zip(case.control_points.names, case.control_points.sources, strict=True))
        assert at["front left"][0] > at["windscreen right"][0] > at["roof left"][0] > at["rear left"][0]
        assert at["front left"][2] < 0 < at["front right"][2]
