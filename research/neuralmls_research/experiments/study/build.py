"""Making the study: every deformation with every method that applies, drawn, in one page that needs nothing else."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from importlib.resources import files

import numpy as np
from numpy.typing import NDArray

from neuralmls.errors import ArgumentError, NotApplicable
from neuralmls_research.experiments.methods import METHODS, Method
from neuralmls_research.experiments.study.cases import Case
from neuralmls_research.experiments.study.key import Question, sealed
from neuralmls_research.experiments.study.pictures import pictures

# Nobody can tell exact handles from soft ones by looking: asking for both would split the votes.
ASKED = {name: method for name, method in METHODS.items() if name not in ("neural-exact", "shape-aware")}
HEIGHT = 600  # pixels of a picture: twice what it takes on a page of 1280 x 720
# Where the camera stands for each category: degrees from the front to the left, and above the ground.
VIEWS = {"chair": (34.0, 18.0), "airplane": (38.0, 32.0), "car": (36.0, 16.0)}
DEFAULT_VIEW = (34.0, 18.0)


@dataclass(frozen=True)
class Study:
    """A study that is ready to be given to participants.

    Attributes
    ----------
    id : str
        What its answers name it by.
    page : str
        The HTML page, with everything in it.
    questions : list of Question
        What is asked, which methods are shown, and why others are not.
    """

    id: str
    page: str
    questions: list[Question]


def build(
    cases: Iterable[Case],
    *,
    kpd: Mapping[str, Method] | None = None,
    methods: Mapping[str, Method] = ASKED,
    height: int = HEIGHT,
    seed: int = 0,
    progress: Callable[[int], None] | None = None,
) -> Study:
    """Deform each case with each method, draw the results, and put the page together.

    Parameters
    ----------
    cases : iterable of Case
        A question each.
    kpd : dict, optional
        KeypointDeformer by the category that its network is for.
    methods : dict
        The other methods by name. One that does not apply to a shape is left out of its questions.
    height : int, pixels of a picture
    seed : int
        Of the order of the results in the page's file. Participants see them in orders of their own.
    progress : callable, optional
        Told how many cases are done.

    Raises
    ------
    ArgumentError
        There is no case, or fewer than two methods apply to one.
    NeuralMLSError
        An extra that is needed is not installed, or this machine cannot draw.
    """
    draw = np.random.default_rng(seed)
    questions: list[Question] = []
    shown = []
    for number, case in enumerate(cases, 1):
        results, left_out = _results(case, methods, (kpd or {}).get(case.category))
        names = tuple(np.array(list(results))[draw.permutation(len(results))].tolist())
        azimuth, elevation = VIEWS.get(case.category, DEFAULT_VIEW)
        source, *drawn = pictures(
            case.shape,
            case.control_points,
            [results[name] for name in names],
            height=height,
            azimuth=azimuth,
            elevation=elevation,
        )
        question = Question(f"q{number}", case.category, case.name, case.displacement, case.origin, names, left_out)
        questions.append(question)
        shown.append({"id": question.id, "source": source, "results": drawn})
        if progress is not None:
            progress(number)
    if not questions:
        raise ArgumentError("cases: expected at least one deformation, found none")
    digest = hashlib.sha256(json.dumps(shown).encode()).hexdigest()
    study, key = sealed(questions, digest)
    return Study(study, page({"id": study, "key": key, "questions": shown}), questions)


def _results(
    case: Case, methods: Mapping[str, Method], kpd: Method | None
) -> tuple[dict[str, NDArray[np.float64]], dict[str, str]]:
    """The results of the methods that apply, and why the others do not."""
    results, left_out = {}, {}
    if kpd is None:
        left_out["kpd"] = f"KeypointDeformer has no network for the category {case.category}"
    else:
        methods = {**methods, "kpd": kpd}
    for name, method in methods.items():
        try:
            results[name] = method(case.shape, case.control_points.sources, case.control_points.targets)
        except NotApplicable as refusal:
            left_out[name] = str(refusal)
    if len(results) < 2:
        raise ArgumentError(
            f"{case.name}, {case.displacement}: expected at least two methods that apply to it, found {list(results)}"
        )
    return results, left_out


def page(content: Mapping[str, object]) -> str:
    """The page's HTML with its style, its script and the study in it."""
    folder = files(__package__) / "page"
    html, style, script = ((folder / f"study.{ending}").read_text("utf-8") for ending in ("html", "css", "js"))
    data = json.dumps(content).replace("<", "\\u003c")  # no text in it can end the script element
    for name, text in (("style", style), ("script", script), ("study", data)):
        before, after = html.split("{{" + name + "}}")
        html = before + text.strip() + after
    return html
