"""Making the study: every deformation with every method that applies, drawn, in one page that needs nothing else."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Iterable, Mapping
from dataclasses import asdict, dataclass
from importlib.resources import files
from typing import Any

import numpy as np
from numpy.typing import NDArray

from neuralmls.errors import ArgumentError, NotApplicable
from neuralmls_research.experiments.methods import KPD, METHODS, Method, classic
from neuralmls_research.experiments.study.cases import Case
from neuralmls_research.experiments.study.key import Question, sealed
from neuralmls_research.experiments.study.pictures import pictures
from neuralmls_research.experiments.study.store import Store
from neuralmls_research.experiments.study.wording import WORDINGS

# The paper's three: the third, for categories that there are weights of.
ASKED = ("neural", "classic", KPD)
# The published study's script has classic weights of 1/d^2, unlike the paper's other comparisons.
STUDY_METHODS: dict[str, Method] = METHODS | {"classic": classic(alpha=1.0)}
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
    kept : int
        How many of them were made before, by a build that was stopped.
    """

    id: str
    page: str
    questions: list[Question]
    kept: int


def build(
    cases: Iterable[Case],
    *,
    methods: Mapping[str, Method],
    kpd: Mapping[str, Method] | None = None,
    question: str = "realistic",
    height: int = HEIGHT,
    seed: int = 0,
    store: Store | None = None,
    progress: Callable[[int], None] | None = None,
) -> Study:
    """Deform each case with each method, draw the results, and put the page together.

    Parameters
    ----------
    cases : iterable of Case
        A question each.
    methods : dict
        Methods by name. One that does not apply to a shape is left out of its questions.
    kpd : dict, optional
        KeypointDeformer by the category that its network is for; not asked for if not given.
    question : one of `WORDINGS`
    height : int, pixels of a picture
    seed : int
        Of the order of the results in the page's file. Participants see them in orders of their own.
    store : Store, optional
        Where questions are kept as they are made, and taken from if they were.
    progress : callable, optional
        Told how many cases are done.

    Raises
    ------
    ArgumentError
        There is no case, or fewer than two methods apply to one.
    NeuralMLSError
        An extra that is needed is not installed, or this machine cannot draw.
    """
    questions: list[Question] = []
    shown = []
    kept = 0
    for number, case in enumerate(cases, 1):
        made = None if store is None else store.get(number, case)
        kept += made is not None
        if made is None:
            made = _made(case, methods, kpd, height, np.random.default_rng([seed, number]))
            if store is not None:
                store.put(number, case, made)
        names, left_out = tuple(made["methods"]), made["left_out"]
        identity = f"q{number}", case.category, case.name, case.displacement, case.origin
        questions.append(Question(*identity, names, left_out, question))
        shown.append({"id": questions[-1].id, "source": made["source"], "results": made["results"]})
        if progress is not None:
            progress(number)
    if not questions:
        raise ArgumentError("cases: expected at least one deformation, found none")
    digest = hashlib.sha256(json.dumps(shown).encode()).hexdigest()
    study, key = sealed(questions, digest)
    return Study(study, page({"id": study, "key": key, "questions": shown}, question), questions, kept)


def _made(
    case: Case, methods: Mapping[str, Method], kpd: Mapping[str, Method] | None, height: int, draw: np.random.Generator
) -> dict[str, Any]:
    """A question: the names of its methods in an order drawn by lot, their pictures, and why others have none."""
    results, left_out = _results(case, methods, kpd)
    names = np.array(list(results))[draw.permutation(len(results))].tolist()
    azimuth, elevation = VIEWS.get(case.category, DEFAULT_VIEW)
    source, *drawn = pictures(
        case.shape,
        case.control_points,
        [results[name] for name in names],
        height=height,
        azimuth=azimuth,
        elevation=elevation,
    )
    return {"methods": names, "left_out": left_out, "source": source, "results": drawn}


def _results(
    case: Case, methods: Mapping[str, Method], kpd: Mapping[str, Method] | None
) -> tuple[dict[str, NDArray[np.float64]], dict[str, str]]:
    """The results of the methods that apply, and why the others do not."""
    results, left_out = {}, {}
    if kpd is not None and case.category in kpd:
        methods = {**methods, KPD: kpd[case.category]}
    elif kpd is not None:
        left_out[KPD] = f"KeypointDeformer has no network for the category {case.category}"
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


def page(content: Mapping[str, object], question: str) -> str:
    """The page's HTML with its words, its style, its script and the study in it."""
    folder = files(__package__) / "page"
    html, style, script = ((folder / f"study.{ending}").read_text("utf-8") for ending in ("html", "css", "js"))
    for name, text in asdict(WORDINGS[question]).items():
        html = html.replace("{{" + name + "}}", text)
    data = json.dumps(content).replace("<", "\\u003c")  # no text in it can end the script element
    for name, text in (("style", style), ("script", script), ("study", data)):
        before, after = html.split("{{" + name + "}}")
        html = before + text.strip() + after
    return html
