"""Figure 1: a network that never saw a displacement serves them all; and what else holds for the method as such."""

from __future__ import annotations

from time import perf_counter

import numpy as np
from numpy.typing import ArrayLike, NDArray

from neuralmls import Deformer, NeuralWeights
from neuralmls.plugin import Progress
from neuralmls_research.experiments.reproduce import verdicts
from neuralmls_research.experiments.reproduce.drawing import draw_shapes
from neuralmls_research.experiments.reproduce.lab import Lab
from neuralmls_research.experiments.reproduce.outcomes import STEPS
from neuralmls_research.experiments.reproduce.report import Claim, Conclusions, Picture, Report
from neuralmls_research.experiments.reproduce.subjects import chair

TASKS = ("user_study_1", "user_study_2", "user_study_3")
# How much of the sample's own displacements is taken, where there is none of the study's.
PARTS = (0.5, 1.0, -0.5)


class Unnormalised:
    """Weights times a number of its own at each point: logits that are off by a constant there."""

    def __init__(self, weights: NeuralWeights) -> None:
        self._weights = weights
        self.control_points = weights.control_points

    def logits(self, x: ArrayLike, *, progress: Progress | None = None) -> NDArray[np.float32]:
        """The logits of `x`, each row with a constant added."""
        logits = self._weights.logits(x, progress=progress)
        constants = np.random.default_rng(0).uniform(-3, 3, (len(logits), 1))
        return (logits + constants).astype(np.float32)


def run(lab: Lab) -> Report:
    """Train once, move three times, and check Proposition 1."""
    subject = chair(lab)
    p, q = subject.points.sources, subject.points.targets
    start = perf_counter()
    weights = NeuralWeights.fit(p, bounds=subject.bounds, width=lab.width, steps=STEPS, seed=lab.seeds[0])
    trained = perf_counter() - start
    deformer = Deformer(subject.positions, weights)
    targets = [p + (q - p) * part for part in PARTS]
    if not subject.ours:
        targets = [chair(lab, task).points.targets for task in TASKS]
    seconds, shapes = [], {}
    for number, target in enumerate(targets, 1):
        start = perf_counter()
        shapes[f"displacement {number}"] = np.asarray(deformer.deform(target), dtype=np.float64)
        seconds.append(perf_counter() - start)
    for number, (label, y) in enumerate(shapes.items(), 1):
        moved = subject.moved(targets[number - 1] - p)
        draw_shapes(lab, f"fig1-{number}.png", moved, {label: y}, 2)
    scaled = Deformer(subject.positions, Unnormalised(weights)).deform(q)
    difference = float(np.abs(deformer.deform(q) - scaled).max())
    frame = float(np.median(seconds))
    faster = verdicts.less("a displacement's time", [frame], trained, "the training's")
    unchanged = verdicts.below(1e-4, [difference])
    return Report(
        f"{subject.label}, {len(subject.positions):,} vertices; one network of width {lab.width}, {STEPS} steps, "
        "rigid.",
        pictures=[
            Picture(f"fig1-{number}.png", f"Displacement {number} of 3, by the same network.") for number in (1, 2, 3)
        ],
        claims=[
            Claim(
                paper="The network is trained on the control points alone; then the user drags freely.",
                measure="Time of the training, and of a displacement.",
                measured=f"Trained once in {trained:.2f} s, before any displacement; one takes {1000 * frame:.1f} "
                f"ms (median of "
                f"three) for {len(subject.positions):,} vertices, on this machine.",
                ruling=faster,
                conclusions=Conclusions(
                    "One training serves all displacements.",
                    "The training takes as long as a displacement.",
                    "A displacement takes longer than the training.",
                ),
            ),
            Claim(
                paper="Proposition 1: MLS is the same for weights and for normalised weights.",
                measure="The farthest that a vertex moves, in halves of the longest side.",
                measured=f"Weights multiplied by numbers between 0.05 and 20, another one at each point, move no "
                f"vertex by more "
                f"than {difference:.1g} of half of the longest side.",
                ruling=unchanged,
                conclusions=Conclusions(
                    "Weights can be normalised without a change.",
                    "Weights can be normalised, up to rounding that shows.",
                    "Normalising the weights changes the deformation.",
                ),
            ),
        ],
        missing=subject.missing,
        numbers={"seconds_of_training": trained, "seconds_a_frame": seconds, "proposition_1_difference": difference},
    )
