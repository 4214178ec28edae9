"""The paper's experiments: every item gives pictures, numbers and claims; the page has them; Table 1 comes out."""

import csv
import json
import math
import re
from collections.abc import Iterator
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

pytest.importorskip("pyvista", reason="the extra 'figures' is not installed")
pytest.importorskip("matplotlib", reason="the extra 'figures' is not installed")
pytest.importorskip("igl", reason="the extra 'baselines' is not installed")

from PIL import Image

from neuralmls.cli import main
from neuralmls.errors import ArgumentError
from neuralmls_research.experiments.reproduce import deformation_1d, subjects, weights_1d
from neuralmls_research.experiments.reproduce.formats import PICTURES, files
from neuralmls_research.experiments.reproduce.items import ITEMS, NAMES, Item, chosen
from neuralmls_research.experiments.reproduce.lab import Lab
from neuralmls_research.experiments.reproduce.line import peaks
from neuralmls_research.experiments.reproduce.outcomes import CLASSIC_LABEL, KPD_LABEL
from neuralmls_research.experiments.reproduce.page import page
from neuralmls_research.experiments.reproduce.report import Claim, Conclusions, Picture, Report, Table
from neuralmls_research.experiments.reproduce.run import reproduce
from neuralmls_research.experiments.reproduce.sharp_edges import angles, neighbours, single
from neuralmls_research.experiments.reproduce.table1_airplane import of_airplane
from neuralmls_research.experiments.reproduce.verdicts import Ruling, Verdict

SQUARE = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
HALVES = np.array([[0, 1, 2], [0, 2, 3]])


@pytest.fixture(scope="module")
def everything(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, dict[Item, Report]]:
    """All items on coarse shapes of ours."""
    folder = tmp_path_factory.mktemp("reproduce")
    return folder, reproduce(ITEMS, Lab(folder, quick=True, seeds=(0, 1)))[1]


def floats(value: object) -> Iterator[float]:
    if isinstance(value, dict):
        for inner in value.values():
            yield from floats(inner)
    elif isinstance(value, list):
        for inner in value:
            yield from floats(inner)
    elif isinstance(value, int | float):
        yield float(value)


def area(x: np.ndarray, faces: np.ndarray) -> float:
    a, b, c = (x[faces[:, i]] for i in range(3))
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2)


@pytest.mark.parametrize("item", ITEMS, ids=NAMES)
def test_each_item_gives_something_to_see_and_finite_numbers(everything, item):
    folder, reports = everything
    report = reports[item]
    assert report.setting
    assert report.claims
    assert report.pictures or report.tables
    for picture in report.pictures:
        assert np.asarray(Image.open(folder / picture.file).convert("L")).std() > 3, f"{picture.file} is blank"
        assert picture.caption
    found = list(floats(report.numbers))
    assert found
    assert all(map(math.isfinite, found))


def test_the_page_shows_every_picture_claim_and_gap(everything):
    folder, reports = everything
    html = (folder / "index.html").read_text()
    shown = set(re.findall(r'<img src="([^"]+)"', html))
    assert shown == {picture.file for report in reports.values() for picture in report.pictures}
    assert not any("/" in file or ":" in file for file in shown)  # the folder can be moved
    ids = set(re.findall(r'id="([^"]+)"', html))
    assert set(re.findall(r'href="#([^"]+)"', html)) <= ids
    claims = [claim for report in reports.values() for claim in report.claims]
    table = html[: html.index("</table>")]  # the page begins with it
    assert len(re.findall("<tr[^>]*><td>", table)) == len(claims)
    assert table.count("Our own check") == sum(claim.ours for claim in claims)
    assert "creature" in html  # what stands in for the armadillo
    assert str(folder) not in html


def test_the_page_links_each_picture_and_table_in_all_its_formats(everything):
    folder, reports = everything
    html = (folder / "index.html").read_text()
    linked = set(re.findall(r'href="([^"#:]+)"', html)) - {"numbers.json"}
    pictures = [picture.file for report in reports.values() for picture in report.pictures]
    tables = ["verdicts", *(table.name for report in reports.values() for table in report.tables)]
    expected = {name for file in pictures for name in files(file, PICTURES)}
    assert linked == expected | {f"{name}{suffix}" for name in tables for suffix in (".csv", ".tex")}
    for name in linked:
        content = (folder / name).read_bytes()
        if name.endswith(".svg"):
            assert ElementTree.fromstring(content).tag == "{http://www.w3.org/2000/svg}svg"
        elif name.endswith(".pdf"):
            assert content.startswith(b"%PDF-")
            assert content.rstrip().endswith(b"%%EOF")
        elif name.endswith(".csv"):
            head, *rows = csv.reader(content.decode().splitlines())
            assert rows
            assert {len(row) for row in rows} == {len(head)}
        elif name.endswith(".tex"):
            assert content.count(rb"\begin{tabular}") == content.count(rb"\end{tabular}") == 1


def test_the_numbers_are_written_for_machines_too(everything):
    folder, reports = everything
    whole = json.loads((folder / "numbers.json").read_text())
    assert {"date", "version", "commit", "changed", "machine", "seeds", "seconds"} < set(whole)
    assert whole["seeds"] == [0, 1]
    assert set(whole["seconds"]) == set(NAMES)
    assert whole["machine"]["processor"]
    assert whole["machine"]["packages"]["numpy"] == np.__version__
    stored = whole["items"]
    assert list(stored) == list(NAMES)
    for item, report in reports.items():
        assert [claim["verdict"] for claim in stored[item.name]["claims"]] == [c.verdict for c in report.claims]


@pytest.mark.parametrize("name", ["fig4", "table1", "fig6"])
def test_what_is_not_in_the_paper_stands_beside_it_and_says_so(everything, name):
    item = chosen([name])[0]
    report = everything[1][item]
    rows = {row[0] for table in report.tables for row in table.rows}
    columns = {title for table in report.tables for title in table.head}
    beyond = {label for label in rows | columns if "(ours)" in label}
    assert beyond == {"neural, exact (ours)", "shape-aware (ours)", "shape-aware, exact (ours)"}
    assert CLASSIC_LABEL in rows | columns
    assert "marked (ours) is not in the paper" in report.setting


def test_without_the_papers_shapes_the_reports_say_so(everything):
    _, reports = everything
    for item in chosen(["fig1", "fig4", "fig5", "table1", "fig8", "fig9", "fig10", "training", "fourier"]):
        assert any("$NEURALMLS_DATA" in sentence for sentence in reports[item].missing), item.name


def test_a_claim_about_the_papers_own_airplane_has_no_verdict_without_it(everything):
    _, reports = everything
    (claim,) = (c for c in reports[chosen(["table1"])[0]].claims if "1764" in c.paper)
    assert claim.verdict == Verdict.UNTESTABLE


def test_neural_weights_on_a_line_have_one_peak_each(tmp_path):
    report = weights_1d.run(Lab(tmp_path, seeds=(0,)))
    most, far = report.numbers["peaks"], report.numbers["change_far_away"]
    assert most["neural"] == [1]
    assert most["classic_raw"] == 1 < most["classic_normalised"]
    assert far["neural"][0] < far["classic_normalised"]
    assert all(claim.verdict == Verdict.REPRODUCED for claim in report.claims)


def test_the_neural_deformation_of_a_line_only_rises_where_its_targets_do(tmp_path):
    report = deformation_1d.run(Lab(tmp_path, seeds=(0,)))
    assert report.numbers["goes_down_by"]["rigid"]["neural"][0] < 0.01
    assert report.numbers["goes_down_by"]["rigid"]["classic_1/d"][0] > 1


def test_table_1_has_the_papers_order_for_every_seed(tmp_path, data, golden):
    report = Report("")
    of_airplane(Lab(tmp_path, data, golden), report)
    numbers = report.numbers["airplane"]
    (classic,), (kpd,) = (numbers["single"][label] for label in (CLASSIC_LABEL, KPD_LABEL))
    assert len(numbers["single"]["neural"]) == 4
    assert max(numbers["single"]["neural"]) < classic < kpd
    assert kpd == pytest.approx(554, abs=1)
    assert all(0.88 <= ratio <= 0.96 for ratio in numbers["ratios_of_the_seeds"])
    assert {claim.paper[:7]: claim.verdict for claim in report.claims}["Table 1"] == "reproduced"


def test_the_papers_shapes_are_used_where_the_data_is(tmp_path, data):
    lab = Lab(tmp_path, data, quick=True)
    made = [make(lab) for make in (subjects.chair, subjects.plain_chair, subjects.airplane, subjects.organic)]
    assert not any(subject.ours for subject in made)
    assert [len(subject.points) for subject in made] == [12, 10, 8, 12]
    for subject in made:
        assert np.abs(subject.bounds).max() == pytest.approx(1)
        assert np.abs(subject.points.sources).max() < 1.1


def test_items_come_in_the_papers_order_and_unknown_ones_are_refused():
    assert [item.name for item in chosen(["fig8", "fig2"])] == ["fig2", "fig8"]
    assert chosen(["all"]) == list(ITEMS)
    with pytest.raises(ArgumentError, match="no item 'tabel1'; the nearest name is 'table1'"):
        chosen(["tabel1"])


def test_the_page_escapes_what_it_is_given():
    report = Report(
        "a < b",
        [Picture("a.png", 'x & "y"')],
        [Table("t", "T > 1", ["<m>"], [["&"]])],
        [
            Claim("1 < 2", "<i>", Ruling("<u>", Verdict.REPRODUCED), "<b>", Conclusions("<s>", "", "")),
            Claim("3 < 2", "", Ruling("", Verdict.CONTRADICTED), ""),
            Claim("ours", "", Ruling("", Verdict.CONTRADICTED), "", ours=True),
        ],
        missing=["<all>"],
    )
    html = page({ITEMS[0]: report}, "0.0.0")
    assert "<m>" not in html
    assert "<all>" not in html
    for text in ("A &lt; b", "x &amp; &quot;y&quot;", "&lt;m&gt;", "&lt;b&gt;", "&lt;i&gt;", "&lt;u&gt;", "&lt;s&gt;"):
        assert text in html


def test_checks_of_our_own_have_no_part_in_the_papers_verdicts():
    kinds = [(Verdict.REPRODUCED, False), (Verdict.CONTRADICTED, False), (Verdict.CONTRADICTED, True)]
    html = page(
        {ITEMS[0]: Report("s", claims=[Claim("p", "m", Ruling("r", v), "m", ours=ours) for v, ours in kinds])}, "0"
    )
    assert "1 reproduced, 0 partly reproduced, 1 contradicted, 0 cannot be tested here" in html
    assert html.count("Our own check") == 1


@pytest.mark.parametrize("verdict", Verdict)
def test_what_a_reader_is_told_follows_the_verdict(verdict):
    told = Claim("p", "m", Ruling("r", verdict), "m", Conclusions("yes", "in part", "no")).reader
    assert told == ["yes", "in part", "no", "Nothing can be concluded from this run."][list(Verdict).index(verdict)]


def test_every_claim_has_a_rule_and_a_conclusion_and_every_table_its_own_name(everything):
    reports = everything[1].values()
    for claim in (claim for report in reports for claim in report.claims):
        assert all((claim.paper, claim.measure, claim.ruling.rule, claim.measured, claim.reader)), claim
        assert isinstance(claim.verdict, Verdict)
    names = [table.name for report in reports for table in report.tables]
    assert len(set(names)) == len(names)
    assert all(re.fullmatch(r"[a-z0-9-]+", name) for name in names)


def test_cutting_keeps_the_surface_and_shortens_its_edges():
    x, faces = subjects.cut(SQUARE, HALVES, 0.3)
    edges = np.linalg.norm(x[faces] - x[np.roll(faces, -1, axis=1)], axis=-1)
    assert edges.max() <= 0.3
    assert area(x, faces) == pytest.approx(1)
    assert len(np.unique(x, axis=0)) == len(x)
    on_border = ((x == 0) | (x == 1))[:, :2].any(axis=1).sum()  # as many border edges as vertices there
    assert 2 * len(neighbours(faces)[0]) == 3 * len(faces) - on_border  # no vertex hangs beside an edge


def test_the_creature_is_closed_and_manifold(tmp_path):
    subject = subjects.organic(Lab(tmp_path, quick=True))
    pairs, _ = neighbours(subject.faces)
    assert 2 * len(pairs) == 3 * len(subject.faces)


def test_angles_between_triangles_are_those_of_a_fold():
    folded = SQUARE.copy()
    folded[3] = [0.5, 0.5, math.sqrt(0.5)]  # upright above the diagonal
    pairs, _ = neighbours(HALVES)
    assert angles(SQUARE, HALVES, pairs).tolist() == [0.0]
    assert angles(folded, HALVES, pairs) == pytest.approx([90.0])


def test_two_sided_sheets_count_once():
    doubled = np.concatenate([HALVES, HALVES[:, ::-1] + 4])
    assert len(single(np.concatenate([SQUARE, SQUARE]), doubled)) == 2


def test_peaks_are_counted_ends_included():
    assert peaks(np.array([1.0, 0.0, 1.0])) == 2
    assert peaks(np.linspace(0, 1, 9)) == 1
    assert peaks(np.array([0.0, 1.0, 0.995, 1.0, 0.0])) == 1  # a ripple is none


def test_the_command_writes_the_page_once(tmp_path, capsys, monkeypatch):
    monkeypatch.delenv("NEURALMLS_DATA", raising=False)
    folder = tmp_path / "new"
    assert main(["reproduce", "fig7", "-o", str(folder)]) == 0
    told = capsys.readouterr().out
    assert "index.html: 1 partly reproduced, 2 reproduced" in told.replace("\n", " ")
    assert (folder / "fig7-deformation.png").exists()
    assert main(["reproduce", "fig7", "-o", str(folder)]) == 2
    assert "--force overwrites it" in capsys.readouterr().err


def test_the_command_refuses_an_unknown_item_before_it_makes_a_folder(tmp_path, capsys):
    assert main(["reproduce", "fig99", "-o", str(tmp_path / "new")]) == 2
    assert "no item 'fig99'" in capsys.readouterr().err
    assert not (tmp_path / "new").exists()


def test_data_that_is_not_where_it_should_be_is_refused(tmp_path, capsys, monkeypatch):
    monkeypatch.setenv("NEURALMLS_DATA", str(tmp_path / "nowhere"))
    assert main(["reproduce", "fig7", "-o", str(tmp_path / "new")]) == 1
    assert "$NEURALMLS_DATA: there is no folder" in capsys.readouterr().err
    assert not (tmp_path / "new").exists()


def test_the_index_shows_in_a_browser_with_all_its_pictures(everything, browser, pictures):
    folder, _ = everything
    tab = browser.new_page(viewport={"width": 1280, "height": 720})
    asked, errors = [], []
    tab.on("request", lambda request: asked.append(request.url))
    tab.on("pageerror", lambda error: errors.append(str(error)))
    tab.goto((folder / "index.html").as_uri())
    loaded = "image => { image.loading = 'eager'; return image.decode().then(() => image.naturalWidth) }"
    sizes = tab.locator("img").evaluate_all(f"images => Promise.all(images.map({loaded}))")
    tab.screenshot(path=pictures / "reproduce-index.png", full_page=True)
    tab.close()
    assert len(sizes) >= len(ITEMS)
    assert all(size > 100 for size in sizes)
    assert all(url.startswith(folder.as_uri()) for url in asked)
    assert errors == []
