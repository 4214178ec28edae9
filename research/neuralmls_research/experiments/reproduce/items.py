"""The experiments by name, in the order of the paper."""

from __future__ import annotations

import difflib
from collections.abc import Sequence
from dataclasses import dataclass
from importlib import import_module

from neuralmls.errors import ArgumentError
from neuralmls_research.experiments.reproduce.lab import Lab
from neuralmls_research.experiments.reproduce.report import Report


@dataclass(frozen=True)
class Item:
    """One figure or table: a name for the command line, a title, and the module whose `run` makes it."""

    name: str
    title: str
    module: str

    def run(self, lab: Lab) -> Report:
        """Run the experiment."""
        module = import_module(f"neuralmls_research.experiments.reproduce.{self.module}")
        report: Report = module.run(lab)
        return report


ITEMS = (
    Item("fig1", "Figure 1: one network, several displacements", "displacements"),
    Item("fig2", "Figure 2: weights on a line", "weights_1d"),
    Item("fig3", "Figure 3: the method at a glance", "overview"),
    Item("square", "Weights of a square of control points", "weights_2d"),
    Item("fig4", "Figure 4: methods side by side", "comparison"),
    Item("fig5", "Figure 5: sharp edges", "sharp_edges"),
    Item("table1", "Table 1: distortion", "table1"),
    Item("fig6", "Figure 6: distortion against control-point error", "scatter"),
    Item("fig7", "Figure 7: deformations and weights on a line", "deformation_1d"),
    Item("fig8", "Figure 8: temperature", "temperature"),
    Item("fig9", "Figure 9: alpha of classic weights", "alpha"),
    Item("fig10", "Figure 10: epsilon of classic weights", "epsilon"),
    Item("training", "Width, steps and seed of the network", "training"),
    Item("fourier", "Fourier features and affine maps", "fourier"),
)
NAMES = tuple(item.name for item in ITEMS)


def chosen(names: Sequence[str]) -> list[Item]:
    """The items of these names, in the paper's order; "all" is all of them.

    Raises
    ------
    ArgumentError
        There is no such item.
    """
    for name in names:
        if name not in (*NAMES, "all"):
            nearest = difflib.get_close_matches(name, NAMES, n=1, cutoff=0.0)[0]
            raise ArgumentError(f"there is no item '{name}'; the nearest name is '{nearest}'")
    return [item for item in ITEMS if "all" in names or item.name in names]
