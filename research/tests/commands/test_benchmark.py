"""`neuralmls benchmark poses`."""

from __future__ import annotations

import json

import numpy as np
import pytest

from neuralmls.errors import NeuralMLSError
from neuralmls_research.experiments.against_rivals import Measured, against_rivals, missing, orders_by_seed
from neuralmls_research.experiments.methods import of_shapes
from neuralmls_research.experiments.poses import POSE_METHODS, QUICK
from neuralmls_research.experiments.seeds import OtherOrder


@pytest.fixture
def folder(here):
    """Poses of a block of points: moved, turned, and a file that is none."""
    rest = np.random.default_rng(0).uniform(size=(40, 3))
    turned = rest @ np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])
    (here / "poses").mkdir()
    faces = np.concatenate([np.arange(39).reshape(-1, 3), [[0, 1, 3], [0, 1, 4]]])  # an edge on three faces
    np.savez(here / "poses" / "block.npz", rest=rest, poses=np.stack([rest + 2, turned]), faces=faces)
    return here / "poses"


POSES = ("benchmark", "poses", "poses", "--counts", "4,6")


def test_rigid_motion_is_found_by_moving_least_squares(run, folder):
    told = json.loads(run(*POSES, "--methods", "classic,neural", "--json").out)
    assert [row["control_points"] for row in told["rows"]] == [4, 6]
    for row in told["rows"]:
        assert row["errors"] == {"classic": pytest.approx(0, abs=1e-6), "neural": pytest.approx(0, abs=1e-6)}
        assert row["not_applicable"] == {}


def test_table_of_poses(run, folder):
    pytest.importorskip("igl")
    ran = run(*POSES)
    assert ran.code == 0
    head = next(line for line in ran.out.splitlines() if "control points" in line).split()
    assert head == ["file", "control", "points", *QUICK]
    for title in ("NeuralMLS (200 steps)", "Classic MLS (alpha 2: 1/d^4)", "ARAP from the rigid fit"):
        assert title in ran.out
    assert "arap does not apply to block, 4 control points: ARAP needs" in ran.out


def test_our_methods_are_judged_against_the_best_rival_of_each_file(run, folder):
    asked = (*POSES, "--methods", "neural,classic,rbf,arap", "--steps", "5")
    told = json.loads(run(*asked, "--json").out)
    assert [verdict["control_points"] for verdict in told["against_best_rival"]] == [4, 6]
    for verdict, row in zip(told["against_best_rival"], told["rows"], strict=True):
        assert verdict["rivals"] == ["classic", "rbf", "arap"]
        assert list(verdict["ratios"]) == ["neural"]
        assert verdict["without"] == {"poses/block.npz": ["arap"]}
        assert row["errors"]["arap"] is None
        assert len(row["by_seed_and_pose"]["neural"][0]) == 2
    out = run(*asked).out
    assert "against the best rival of each file: classic, rbf, arap" in out
    assert "block, 4 control points: without arap" in out
    assert "95% interval" in out


def test_a_rival_whose_library_is_missing_is_named_and_the_others_are_measured(run, folder, monkeypatch):
    def missing(*_):
        raise NeuralMLSError("this baseline needs igl, which is not installed")

    monkeypatch.setitem(POSE_METHODS, "arap", of_shapes("ARAP", missing))
    ran = run(*POSES, "--methods", "classic,arap")
    assert ran.code == 0
    assert "arap does not apply to block, 4 control points: this baseline needs igl" in ran.out
    assert "0.00" in ran.out


def test_seeds_of_the_benchmark(run, folder):
    asked = (*POSES, "--methods", "neural,classic", "--steps", "2", "--width", "8", "--seeds", "3")
    told = json.loads(run(*asked, "--json").out)
    assert told["seeds"] == [0, 1, 2]
    for row in told["rows"]:
        assert (len(row["by_seed_and_pose"]["neural"]), len(row["by_seed_and_pose"]["classic"])) == (3, 1)
        assert row["errors"]["neural"] == pytest.approx(np.mean(row["by_seed_and_pose"]["neural"]))
    assert "means over seeds 0 to 2" in run(*asked).out


ROWS = [
    Measured("a", 12, {"ours": [[1.0, 1.0], [3.0, 3.0]], "one": [[2.0, 2.0]], "other": [[4.0, 4.0]]}),
    Measured("b", 12, {"ours": [[1.0], [1.0]], "one": [[4.0]]}, {"other": "it does not apply"}),
]


def test_made_up_errors_give_the_ratio_that_they_must():
    found = against_rivals(ROWS, ["ours"], ["one", "other"])["ours"]
    assert found.ratio == pytest.approx((2 / 2 * 1 / 4) ** 0.5)  # the mean over seeds, against the better rival
    assert (found.won, found.files) == (1, 2)
    assert missing(ROWS, ["one", "other"]) == {"b": ["other"]}


def test_an_order_is_taken_where_all_methods_apply():
    assert orders_by_seed(ROWS, ["ours", "one", "other"], [0, 1]) == [OtherOrder("ours", "one", (1,))]
    assert orders_by_seed(ROWS, ["ours", "one"], [0, 1]) == []  # with b, ours is better with both seeds
    assert orders_by_seed(ROWS, ["ours", "one"], [0]) == []


def test_a_bad_file_is_one_sentence_and_the_others_are_measured(run, folder):
    (folder / "bad.npz").write_bytes(b"nothing")
    ran = run(*POSES, "--methods", "classic")
    assert ran.code == 1
    assert ran.err.startswith("neuralmls: error: poses/bad.npz: this is no .npz file of arrays: ")
    assert ran.err.count("\n") == 1
    assert "block" in ran.out
    (folder / "block.npz").unlink()
    ran = run(*POSES, "--methods", "classic")
    assert (ran.code, ran.out) == (1, "")


def test_what_benchmark_cannot_do_is_refused(refused, folder, here):
    (here / "empty").mkdir()
    refused(1, "benchmark", "poses", "none", words=("none", "folder of .npz files"))
    refused(1, "benchmark", "poses", "empty", words=("empty", "no .npz file"))
    refused(2, "benchmark", "poses", "poses", "--methods", "classic,magic", words=("--methods", "'magic'"))
    for counts in ("0", "a", "", "4,,6", "-3"):
        refused(2, "benchmark", "poses", "poses", f"--counts={counts}", words=("--counts",))
    refused(1, *POSES[:3], "--counts", "41", "--methods", "classic", words=("block.npz", "at most 40", "found 41"))
    refused(2, "benchmark", words=("missing command",))
