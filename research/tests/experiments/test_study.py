"""The study without its browser: which deformations, what the page holds, what is counted, what is refused."""

from __future__ import annotations

import csv
import json
import re
from dataclasses import replace
from math import sqrt
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("pyvista", reason="the extra 'figures' is not installed")

from neuralmls.cli import main
from neuralmls.errors import ArgumentError, FileError
from neuralmls_research.experiments.study.answers import read_answers
from neuralmls_research.experiments.study.build import Study, build, page
from neuralmls_research.experiments.study.cases import CATEGORIES, COUNT, cases
from neuralmls_research.experiments.study.key import Question, opened, sealed
from neuralmls_research.experiments.study.report import interval, shares
from neuralmls_research.experiments.study.variants import VARIANTS, made
from research.tests.experiments.study_of_boxes import (
    METHODS_OF_BOXES,
    cases_of_boxes,
    make_study_of_boxes,
    study_of_boxes,
)

QUESTIONS = [
    Question("q1", "chair", "stool", "up", "here", ("classic", "neural"), {"kpd": "no network"}),
    Question("q2", "chair", "bench", "up", "here", ("neural", "classic"), {"kpd": "no network"}),
    Question("q3", "car", "van", "long", "here", ("kpd", "neural", "classic"), {}),
]
STUDY, KEY = sealed(QUESTIONS, "pictures")


def saved(folder: Path, name: str, choices: dict[str, int], **changed: Any) -> Path:
    """A file of answers as the page saves it."""
    document = {
        "format": "neuralmls-study-answers-1", "study": STUDY, "key": KEY, "participant": name, "seed": 1,
        "questions": 3,
        "answers": [{"question": q, "order": [0, 1], "choice": choice} for q, choice in choices.items()],
    }  # fmt: skip
    path = folder / f"{name}.json"
    path.write_text(json.dumps(document | changed))
    return path


@pytest.fixture
def boxes() -> Study:
    return study_of_boxes()


# Which deformations


def test_without_data_the_study_has_27_deformations_of_our_own_shapes():
    found = list(cases(None))
    assert len(found) == COUNT == 27
    assert len({(case.category, case.name, case.displacement) for case in found}) == 27
    for category in CATEGORIES:
        assert len({case.name for case in found if case.category == category}) == 3
    for case in found:
        moved = case.control_points.targets - case.control_points.sources
        bounds = np.stack([case.shape.positions.min(axis=0), case.shape.positions.max(axis=0)])
        side = np.ptp(bounds, axis=0).max()
        assert 0.02 < np.abs(moved).max() / side < 0.25
        assert case.control_points.check(bounds) == []
        assert case.origin == "made by this package"


def test_published_shapes_and_displacements_come_first(data):
    found = list(cases(data))
    assert len(found) == 27
    names = [case.name for case in found[::3]]
    assert names[:2] + names[3:5] == ["ShapeNetChair1", "ShapeNetChair3", "ShapeNetPlane1", "ShapeNetPlane2"]
    first = found[0].control_points
    moved = {
        name: (q - p).round(6).tolist()
        for name, p, q in zip(first.names, first.sources, first.targets, strict=True)
        if (p != q).any()
    }
    half = 0.393927  # of the longest side of ShapeNetChair1, in which the published offsets are given
    assert moved["middle seat"] == pytest.approx([-0.2 * half, 0, 0], abs=1e-5)
    assert moved["front left leg"] == pytest.approx([0.2 * half, -0.2 * half, 0], abs=1e-5)
    assert len(moved) == 5


def test_broken_published_control_points_are_refused(tmp_path):
    folder = tmp_path / "shapenet" / "ShapeNetChair1"
    folder.mkdir(parents=True)
    (folder / "model.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    (tmp_path / "shapenet" / "control_points.json").write_text('{"ShapeNetChair1": {"names": []}}')
    with pytest.raises(FileError, match=r"control_points\.json: expected the paper's control points"):
        list(cases(tmp_path))


def test_a_limousine_is_longer_than_a_hatchback_but_its_wheels_are_as_large():
    hatchback, limousine = (made(variant)[0].positions for variant in VARIANTS["car"][:2])
    assert np.ptp(limousine, axis=0) - np.ptp(hatchback, axis=0) == pytest.approx([0.9, 0, 0], abs=1e-5)  # faces +x

    def tyre(points: np.ndarray) -> np.ndarray:
        low = points[(points[:, 0] > 0) & (points[:, 1] < 0.15)]  # of the front wheels only tyres are so low
        return np.ptp(low, axis=0)

    assert tyre(limousine) == pytest.approx(tyre(hatchback), abs=1e-5)


# What the page holds


def test_the_page_needs_nothing_else_and_names_no_method(boxes):
    page = boxes.page
    assert not re.search(r"""(?:src|href)\s*=\s*["'](?!data:)""", page)
    assert "http:" not in page
    assert "https:" not in page
    assert page.count("data:image/webp;base64,") == 4 + 2 * 2 + 2 * 3
    for name in ("neural", "classic", "shift", "kpd", "arap"):
        assert not re.search(rf"{name}(?!mls)", page, re.IGNORECASE), name


def test_a_method_that_does_not_apply_is_left_out_of_its_questions_only(boxes):
    chair, car = boxes.questions[0], boxes.questions[-1]
    assert sorted(chair.methods) == ["classic", "neural"]
    assert chair.left_out == {
        "shift": "this is no car",
        "keypoint-deformer": "KeypointDeformer has no network for the category chair",
    }
    assert sorted(car.methods) == ["classic", "neural", "shift"]


def test_the_same_study_is_made_again(boxes):
    assert make_study_of_boxes().page == boxes.page


def test_a_question_needs_two_methods(tmp_path):
    only = {"classic": METHODS_OF_BOXES["classic"]}
    with pytest.raises(ArgumentError, match="box chair, up: expected at least two methods"):
        build(cases_of_boxes(tmp_path), methods=only, height=60)
    with pytest.raises(ArgumentError, match="at least one deformation"):
        build([], methods=METHODS_OF_BOXES, height=60)


def test_the_key_opens_to_what_was_sealed_and_only_for_its_study():
    assert opened(STUDY, KEY) == QUESTIONS
    with pytest.raises(FileError, match="not that of its study"):
        opened("0" * 16, KEY)
    with pytest.raises(FileError, match="cannot be read"):
        opened(STUDY, "%%%")
    assert sealed(QUESTIONS, "other pictures")[0] != STUDY


@pytest.mark.parametrize(("question", "words"), [("realistic", "looks most realistic"), ("best", "looks best")])
def test_the_page_asks_what_it_is_told_to(question, words):
    html = page({}, question)
    assert f"<title>Which result {words}?</title>" in html
    assert f"Choose the one that {words} to you:" in html
    assert html.count(words) == 4
    assert "{{" not in html


def test_what_was_asked_is_in_the_key():
    asked = replace(QUESTIONS[0], asked="realistic")
    study, key = sealed([asked], "pictures")
    assert opened(study, key)[0].asked == "realistic"
    assert QUESTIONS[0].asked == "best"  # pages of before did not say


# What is counted


def test_shares_are_of_the_answers_to_which_a_method_was_shown(tmp_path):
    files = [
        saved(tmp_path, "anna", {"q1": 1, "q2": 0, "q3": 1}),  # neural three times
        saved(tmp_path, "bert", {"q1": 0, "q2": 0, "q3": 0}),  # classic, neural, kpd
        saved(tmp_path, "carl", {"q1": 0}),  # classic
    ]
    rows = {(row.category, row.method): row for row in shares(read_answers(files))}
    counts = {where: (row.chosen, row.shown) for where, row in rows.items()}
    assert counts == {
        ("chair", "neural"): (3, 5), ("chair", "classic"): (2, 5),
        ("car", "neural"): (1, 2), ("car", "classic"): (0, 2), ("car", "kpd"): (1, 2),
        ("overall", "neural"): (4, 7), ("overall", "classic"): (2, 7), ("overall", "kpd"): (1, 2),
    }  # fmt: skip
    assert rows["overall", "neural"].chance == pytest.approx((5 / 2 + 2 / 3) / 7)
    for row in rows.values():
        assert 0 <= row.low <= row.share <= row.high <= 1
    assert [row.method for row in shares(read_answers(files))[-3:]] == ["neural", "kpd", "classic"]


def wilson(share: float, answers: float) -> tuple[float, float]:
    """The bounds s of (share - s)^2 = z^2 s (1 - s) / answers, as roots of a quadratic."""
    k = 1.959964**2 / answers
    return tuple(sorted(np.roots([1 + k, -(2 * share + k), share**2]).real))


def test_the_interval_is_wilsons_where_participants_differ_no_more_than_by_chance():
    counts = [(5, 10), (6, 10), (5, 10), (4, 10)]
    assert interval(counts) == pytest.approx(wilson(0.5, 40), abs=1e-6)


def test_participants_who_always_choose_alike_count_once_each():
    assert interval([(9, 9), (0, 9), (9, 9), (0, 9)]) == pytest.approx(wilson(0.5, 4), abs=1e-6)
    assert interval([(9, 9)] * 6) == pytest.approx(wilson(1.0, 6), abs=1e-6)
    assert interval([(6, 9)]) == pytest.approx(wilson(6 / 9, 1), abs=1e-6)


def test_the_interval_covers_the_truth_as_often_as_it_says_where_participants_differ():
    draw = np.random.default_rng(0)
    truth, people, given = 0.7, 25, 9
    covered = plain = 0
    for _ in range(1500):  # beta-binomial: the answers of one participant correlate by 0.25
        tastes = draw.beta(truth * 3, (1 - truth) * 3, people)
        chosen = draw.binomial(given, tastes)
        low, high = interval([(c, given) for c in chosen])
        covered += low <= truth <= high
        share, half = chosen.sum() / (people * given), 1.96 / sqrt(people * given)
        plain += abs(share - truth) <= half * sqrt(share * (1 - share))
    assert 0.92 < covered / 1500 < 0.975
    assert plain / 1500 < 0.8  # what taking all answers for independent would have given


def test_counts_that_cannot_be_are_refused():
    for counts in ([], [(0, 0)], [(3, 2)], [(-1, 2)], [1, 2]):
        with pytest.raises(ArgumentError, match="counts: expected"):
            interval(counts)


# What is refused


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"format": "something"}, "expected answers of the format"),
        ({"study": "0" * 16}, "its key is not that of its study"),
        ({"key": "AAAA"}, "its key is not that of its study"),
        ({"key": 7}, "expected 'key' to be a text"),
        ({"answers": {}}, "expected 'answers' to be a list"),
        ({"answers": []}, "no question is answered"),
        ({"answers": [{"question": "q9", "choice": 0}]}, "answer 1 is to no question"),
        ({"answers": ["q1"]}, "answer 1 is to no question"),
        ({"answers": [{"question": "q1", "choice": 0}] * 2}, "answer 2 is a second one"),
        ({"answers": [{"question": "q1", "choice": 2}]}, "answer 1: expected a choice from 0 to 1, found 2"),
        ({"answers": [{"question": "q1", "choice": True}]}, "found True"),
        ({"participant": None}, "expected 'participant' to be a text"),
    ],
)
def test_a_file_that_cannot_be_counted_is_refused_by_name(tmp_path, changed, words):
    path = saved(tmp_path, "anna", {"q1": 1}, **changed)
    with pytest.raises(FileError, match=re.escape(f"{path}: ") + ".*" + re.escape(words)):
        read_answers([path])


def test_what_is_no_file_of_answers_is_refused_by_name(tmp_path):
    (tmp_path / "text.json").write_text("hello")
    (tmp_path / "list.json").write_text("[1]")
    for name, words in (("text.json", "no JSON"), ("list.json", "found None"), ("none.json", "cannot read")):
        with pytest.raises(FileError, match=f"{name}: .*{words}"):
            read_answers([tmp_path / name])


def test_answers_to_another_study_and_of_the_same_participant_are_refused(tmp_path):
    anna = saved(tmp_path, "anna", {"q1": 1})
    other_study, other_key = sealed(QUESTIONS[:2], "pictures")
    other = saved(tmp_path, "bert", {"q1": 1}, study=other_study, key=other_key)
    with pytest.raises(FileError, match=r"bert\.json: expected answers to the same study as .*anna\.json"):
        read_answers([anna, other])
    again = saved(tmp_path, "again", {"q1": 0}, participant="anna")
    with pytest.raises(FileError, match=r"again\.json: these are the answers of the same participant as in .*anna"):
        read_answers([anna, again])


# The command line


def test_the_report_for_people_and_for_machines(tmp_path, capsys):
    files = [
        str(saved(tmp_path, "anna", {"q1": 1, "q2": 0, "q3": 1})),
        str(saved(tmp_path, "bert", {"q1": 0, "q2": 0})),
    ]
    assert main(["study", "report", *files]) == 0
    out, err = capsys.readouterr()
    assert "2 participants, 5 of 6 questions answered" in out
    assert re.search(r"chair +neural +75\.0 % +\d+\.\d to \d+\.\d % +3 of 4 +50\.0 %", out)
    assert "1 participant did not answer all 3 questions" in err
    assert "fewer than 10 participants" in err
    assert main(["study", "report", *files, "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert (told["participants"], told["answers"], told["questions"], told["confidence"]) == (2, 5, 3, 0.95)
    neural = next(row for row in told["shares"] if (row["category"], row["method"]) == ("chair", "neural"))
    assert (neural["chosen"], neural["shown"], neural["share"]) == (3, 4, 0.75)
    assert told["left_out"][0]["reason"] == "no network"


def test_the_table_is_written_for_machines_and_for_papers(tmp_path, capsys):
    files = [str(saved(tmp_path, "anna", {"q1": 1, "q2": 0, "q3": 1})), str(saved(tmp_path, "bert", {"q1": 0}))]
    table, paper = tmp_path / "table.csv", tmp_path / "table.tex"
    assert main(["study", "report", *files, "--csv", str(table), "--latex", str(paper)]) == 0
    rows = list(csv.DictReader(table.read_text().splitlines()))
    expected = shares(read_answers(files))
    assert [(row["category"], row["method"]) for row in rows] == [(row.category, row.method) for row in expected]
    assert [float(row["low"]) for row in rows] == [row.low for row in expected]
    text = paper.read_text()
    assert "% 2 participants" in text
    assert [line.split(" & ")[0] for line in text.splitlines() if line.endswith(r" \\")][1:] == [
        "chair",
        "car",
        "overall",
    ]
    chair = next(line for line in text.splitlines() if line.startswith("chair"))
    assert re.fullmatch(r"chair & 66\.7\\,\\% \[[\d., ]+\] & 33\.3\\,\\% \[[\d., ]+\] & -- \\\\", chair)
    assert main(["study", "report", *files, "--csv", str(table)]) == 2
    assert "there is such a file already" in capsys.readouterr().err


def test_a_bad_file_ends_the_report_in_one_sentence(tmp_path, capsys):
    assert main(["study", "report", str(tmp_path / "none.json")]) == 1
    out, err = capsys.readouterr()
    assert out == ""
    assert re.fullmatch(r"neuralmls: error: .*none\.json: cannot read: No such file or directory\n", err)


def test_a_study_is_refused_before_any_work(tmp_path, capsys, monkeypatch):
    monkeypatch.delenv("NEURALMLS_DATA", raising=False)
    (tmp_path / "study.html").write_text("mine")
    for arguments, code, words in (
        (["-o", str(tmp_path)], 2, "there is such a file already"),
        (["-o", str(tmp_path / "study.html")], 1, "study.html"),
        (["-o", str(tmp_path / "new"), "--kpd", "table=x.safetensors"], 2, "expected CATEGORY=FILE"),
        (["-o", str(tmp_path / "new"), "--methods", "neural,magic"], 2, "'magic'"),
        (["-o", str(tmp_path / "new"), "--kpd", "car=none.safetensors"], 1, "none.safetensors"),
    ):
        assert main(["study", "build", *arguments]) == code
        out, err = capsys.readouterr()
        assert (out, err.count("\n")) == ("", 1)
        assert words in err
    assert [path.name for path in tmp_path.iterdir()] == ["study.html"]
    assert (tmp_path / "study.html").read_text() == "mine"
