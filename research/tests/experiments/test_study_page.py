"""The study's page in a real Chromium: answered by keyboard, resumed, exported, reported; pictures of it in out/."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from itertools import islice
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("pyvista", reason="the extra 'figures' is not installed")

from playwright.sync_api import Browser

from neuralmls.cli import main
from neuralmls_research.experiments.methods import METHODS, neural
from neuralmls_research.experiments.study.build import Study, build
from neuralmls_research.experiments.study.cases import cases
from research.tests.experiments.study_of_boxes import METHODS_OF_BOXES, study_of_boxes

KEYS = ["1", "2", "2", "1"]


class Visitor:
    """A browser of its own (no shared storage), on the study's page; what it asks the network for is noted."""

    def __init__(self, browser: Browser, page_file: Path, *, seed: int | None = None, **options: Any) -> None:
        self.context = browser.new_context(viewport={"width": 1280, "height": 720}, accept_downloads=True, **options)
        self.context.set_offline(True)
        self.page = self.context.new_page()
        self.requests: list[str] = []
        self.errors: list[str] = []
        self.page.on("request", lambda request: self.requests.append(request.url))
        self.page.on("pageerror", lambda error: self.errors.append(str(error)))
        self.page.on("console", lambda message: self.errors.append(message.text))
        self.address = page_file.as_uri()
        self.page.goto(self.address + ("" if seed is None else f"#seed={seed}"))

    def press(self, *keys: str) -> None:
        for key in keys:
            self.page.keyboard.press(key)

    def heading(self) -> str:
        return self.page.locator("h1:visible").inner_text()

    def sources(self) -> list[str]:
        """The pictures that are seen, in their order: the source, the results."""
        return self.page.locator("#stage img").evaluate_all("images => images.map(image => image.src)")

    def chosen(self) -> list[int]:
        buttons = self.page.locator(".result")
        return [k + 1 for k in range(buttons.count()) if buttons.nth(k).get_attribute("aria-pressed") == "true"]

    def saved(self, path: Path) -> dict[str, Any]:
        with self.page.expect_download() as download:
            self.page.locator(".save:visible").press("Enter")
        assert re.fullmatch(r"study-answers-[0-9a-f]{8}\.json", download.value.suggested_filename)
        download.value.save_as(path)
        document: dict[str, Any] = json.loads(path.read_text())
        return document


@pytest.fixture
def study() -> Study:
    return study_of_boxes()


@pytest.fixture(scope="module")
def page_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("page") / "study.html"
    path.write_text(study_of_boxes().page)
    return path


@pytest.fixture(scope="module")
def page_of_a_chair(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A page with one question, worth a look."""
    methods = {"neural": neural(steps=48), "classic": METHODS["classic"], "rbf": METHODS["rbf"]}
    path = tmp_path_factory.mktemp("chair") / "study.html"
    path.write_text(build(islice(cases(None), 1), methods=methods, height=400).page)
    return path


@pytest.fixture
def visit(browser: Browser, page_file: Path) -> Iterator[Any]:
    """Open the page as a new visitor; afterwards, nobody has asked the network for anything, or met an error."""
    visitors: list[Visitor] = []

    def open_page(file: Path = page_file, **options: Any) -> Visitor:
        visitors.append(Visitor(browser, file, **options))
        return visitors[-1]

    yield open_page
    for visitor in visitors:
        left = [url for url in visitor.requests if not url.startswith((visitor.address, "data:", "blob:"))]
        visitor.context.close()
        assert left == []
        assert visitor.errors == []


def content(study: Study) -> dict[str, Any]:
    """The page's data: pictures by question."""
    found = re.search(r'<script type="application/json" id="study">(.*?)</script>', study.page, re.DOTALL)
    assert found
    document: dict[str, Any] = json.loads(found[1])
    return document


def test_all_questions_are_answered_by_keyboard_exported_and_reported(visit, study, tmp_path, capsys):
    visitor = visit(seed=3)
    assert visitor.heading() == "Which result looks best?"
    visitor.press("Enter")
    questions = {question["source"]: question for question in content(study)["questions"]}
    expected = {}
    for number, key in enumerate(KEYS, 1):
        assert visitor.heading().startswith(f"Question {number} of 4")
        source, *results = visitor.sources()
        asked = questions[source]
        assert sorted(results) == sorted(asked["results"])
        expected[asked["id"]] = asked["results"].index(results[int(key) - 1])
        visitor.press(key)
        assert visitor.chosen() == [int(key)]
        visitor.press("Enter")
    assert visitor.heading() == "Thank you!"
    document = visitor.saved(tmp_path / "answers.json")
    assert {answer["question"]: answer["choice"] for answer in document["answers"]} == expected
    assert document["seed"] == 3

    assert main(["study", "report", str(tmp_path / "answers.json"), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    by_id = {question.id: question for question in study.questions}
    for row in (row for row in told["shares"] if row["category"] == "overall"):
        chosen = [by_id[question].methods[choice] for question, choice in expected.items()]
        assert row["chosen"] == chosen.count(row["method"])
        assert row["shown"] == sum(row["method"] in question.methods for question in study.questions)


def test_the_order_is_the_seeds_and_differs_between_participants(visit, tmp_path):
    def order(seed: int | None) -> tuple[int, list[Any]]:
        visitor = visit(seed=seed)
        visitor.press("Enter", *(key for _ in range(4) for key in ("1", "Enter")))
        document = visitor.saved(tmp_path / "answers.json")
        return document["seed"], [(answer["question"], answer["order"]) for answer in document["answers"]]

    first = order(1)
    assert order(1) == first
    orders = [first[1], *(order(seed)[1] for seed in (2, 3, 4))]
    assert len({json.dumps(shown) for shown in orders}) == 4
    assert len({json.dumps([question for question, _ in shown]) for shown in orders}) > 1  # the questions' order
    assert len({json.dumps(sorted(shown)) for shown in orders}) > 1  # and that of the results
    assert order(None)[0] != order(None)[0]


def test_no_method_is_named_to_who_looks_or_listens(visit):
    visitor = visit(seed=1)
    visitor.press("Enter")
    for _ in range(4):
        seen = visitor.page.locator("body").inner_html()
        shown = re.sub(r"<script.*?</script>|base64,[^\"]*", "", seen, flags=re.DOTALL)
        for name in METHODS_OF_BOXES:
            assert not re.search(rf"\b{name}\b", shown, re.IGNORECASE)
        named = visitor.page.locator(".result img").evaluate_all("images => images.map(image => image.alt)")
        assert named == [f"Result {k} of {len(named)}" for k in range(1, len(named) + 1)]
        visitor.press("1", "Enter")


def test_a_reloaded_page_goes_on_where_it_was(visit):
    visitor = visit()
    visitor.press("Enter", "2", "Enter", "1", "Enter")
    shown = visitor.sources()
    visitor.page.reload()
    assert visitor.heading().startswith("Question 3 of 4")
    assert visitor.sources() == shown
    visitor.press("ArrowLeft", "ArrowLeft")
    assert visitor.chosen() == [2]


def test_a_broken_memory_of_the_browser_is_begun_anew(visit):
    visitor = visit(seed=1)
    visitor.press("Enter", "1", "Enter")
    for broken in ("hello", "{}", "7", "null"):
        visitor.page.evaluate("text => localStorage.setItem(Object.keys(localStorage)[0], text)", broken)
        visitor.page.reload()
        assert visitor.heading() == "Which result looks best?"
        visitor.press("Enter", "1", "Enter")


def test_on_a_tablet_pictures_are_touched(visit):
    visitor = visit(seed=1, has_touch=True, is_mobile=True)
    assert not visitor.page.locator(".keys").is_visible()
    visitor.page.locator("#begin").tap()
    assert visitor.page.locator("#hint").inner_text() == "Touch the picture that you choose"
    visitor.page.locator(".result").nth(1).tap()
    visitor.page.locator("#next").tap()
    assert visitor.heading().startswith("Question 2 of 4")


def test_a_choice_can_be_changed_and_none_be_left_out(visit, tmp_path):
    visitor = visit(seed=1)
    visitor.press("Enter", "Enter", "ArrowRight", "9")
    assert visitor.heading().startswith("Question 1 of 4")
    assert visitor.page.locator("#message").inner_text() == "Please choose a picture first."
    assert visitor.page.locator("#next").get_attribute("aria-disabled") == "true"
    visitor.press("1", "ArrowRight", "ArrowLeft", "2", "Enter")
    assert visitor.heading().startswith("Question 2 of 4")
    (answer,) = visitor.saved(tmp_path / "half.json")["answers"]
    assert answer["choice"] == answer["order"][1]


def test_every_control_is_reached_by_tab_and_shows_its_focus(visit):
    visitor = visit(seed=1)
    visitor.press("Enter", "1", "Enter")
    reached = []
    for _ in range(8):
        visitor.press("Tab")
        label, outline = visitor.page.evaluate(
            "() => { const e = document.activeElement; const alt = e.querySelector(':scope > img')?.alt;"
            " return [e === document.body ? '' : alt ?? e.textContent.trim(), getComputedStyle(e).outlineStyle]; }"
        )
        if not label:
            break  # beyond the last one
        reached.append(label)
        assert outline == "solid", label
    count = visitor.page.locator(".result").count()
    assert reached[:1] == ["Save for later"]
    assert [label for label in reached if label.startswith("Result")] == [
        f"Result {k + 1} of {count}" for k in range(count)
    ]
    assert reached[-2:] == ["← Back", "Next →"]


def test_saved_answers_go_on_in_another_browser(visit, tmp_path):
    first = visit(seed=7)
    first.press("Enter", "2", "Enter", "1", "Enter")
    begun = first.saved(tmp_path / "begun.json")
    shown = first.sources()

    second = visit()
    second.page.set_input_files("#file", tmp_path / "begun.json")
    second.page.locator("#question").wait_for()
    assert second.sources() == shown
    second.press("1", "Enter", "1", "Enter")
    done = second.saved(tmp_path / "done.json")
    assert done["participant"] == begun["participant"]
    assert done["answers"][:2] == begun["answers"]
    assert len(done["answers"]) == 4


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"format": "else"}, "holds no answers to a study"),
        ({"study": "else"}, "holds answers to another study"),
        ({"answers": [{"question": "q1", "choice": 9}]}, "is damaged"),
        (None, "holds no answers to a study"),
    ],
)
def test_a_wrong_file_is_refused_and_changes_nothing(visit, tmp_path, change, words):
    visitor = visit(seed=1)
    visitor.press("Enter", "1", "Enter")
    good = visitor.saved(tmp_path / "file.json")
    (tmp_path / "file.json").write_text("hello" if change is None else json.dumps(good | change))
    visitor.page.set_input_files("#file", tmp_path / "file.json")
    visitor.page.get_by_text(f"file.json {words}").wait_for()
    assert visitor.heading().startswith("Question 2 of 4")


def test_another_person_on_the_same_device_is_another_participant(visit, tmp_path):
    visitor = visit()
    visitor.press("Enter", *(key for _ in range(4) for key in ("1", "Enter")))
    first = visitor.saved(tmp_path / "first.json")
    visitor.page.once("dialog", lambda dialog: dialog.accept())
    visitor.page.locator("#again").press("Enter")
    assert visitor.heading() == "Which result looks best?"
    visitor.press("Enter", *(key for _ in range(4) for key in ("1", "Enter")))
    second = visitor.saved(tmp_path / "second.json")
    assert first["participant"] != second["participant"]
    assert main(["study", "report", str(tmp_path / "first.json"), str(tmp_path / "second.json")]) == 0


SIZES = [(1280, 720), (1024, 768), (768, 1024)]


def overflow(visitor: Visitor) -> list[int]:
    """By how much the page is higher and wider than the screen."""
    root = "document.documentElement"
    found: list[int] = visitor.page.evaluate(
        f"() => [{root}.scrollHeight - {root}.clientHeight, {root}.scrollWidth - {root}.clientWidth]"
    )
    return found


@pytest.mark.parametrize(("width", "height"), SIZES)
def test_questions_fit_on_the_screen(visit, width, height):
    visitor = visit(seed=1)
    visitor.page.set_viewport_size({"width": width, "height": height})
    visitor.press("Enter")
    for _ in range(4):  # with two and with three results
        assert overflow(visitor) == [0, 0]
        for picture in visitor.page.locator("#stage img").all():
            box = picture.bounding_box()
            assert min(box["width"], box["height"]) > 150
            assert box["y"] + box["height"] < height
        visitor.press("1", "Enter")


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize(("width", "height"), SIZES)
def test_pictures_of_the_page_are_left_to_be_looked_at(visit, page_of_a_chair, pictures, scheme, width, height):
    visitor = visit(page_of_a_chair, seed=1, color_scheme=scheme)
    visitor.page.set_viewport_size({"width": width, "height": height})
    for screen, keys in (("welcome", []), ("question", ["Enter", "2"]), ("end", ["Enter"])):
        visitor.press(*keys)
        assert overflow(visitor) == [0, 0]
        visitor.page.screenshot(path=pictures / f"study-{screen}-{width}x{height}-{scheme}.png")
    ground = visitor.page.evaluate("() => getComputedStyle(document.body).backgroundColor")
    assert (sum(map(int, re.findall(r"\d+", ground))) < 384) == (scheme == "dark")
