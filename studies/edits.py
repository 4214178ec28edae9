"""Edits of manufactured shapes, and what each method makes of them: `python studies/edits.py DATA`, some minutes.

Legs longer, seats wider, backs leaned, wings swept, cabins longer: edit_cases.py has them all. There is no true answer
to an edit. So methods are compared with the best of them on it: how much triangles are strained and bent, how much of
the surface is torn, where parts come apart and where triangles are stretched by far more than the control points ask
for, how many triangles fold, whether control points arrive and feet follow them. Strain and bending are looked at
together, as `spoilt`, too: in strain alone a part that stretches evenly is worse than one that buckles beside it.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from dataclasses import dataclass, fields
from functools import cache
from pathlib import Path

import numpy as np
from edit_cases import Edit, edits

import neuralmls as nm
from neuralmls_research.experiments.loose_parts import with_loose_parts
from neuralmls_research.experiments.methods import METHODS, Array, Bound, Method
from neuralmls_research.metrics import Bends, Contacts, flipped_triangles, overstretched, singular_values
from neuralmls_research.metrics.triangles import normals

RUN: dict[str, Method] = {
    "neural": METHODS["neural-exact"],
    "shape-aware": METHODS["shape-aware-exact"],
    "arap": with_loose_parts(METHODS["arap"]),
    "neural-relax": METHODS["neural-relax"],
    "shape-aware-relax": METHODS["shape-aware-relax"],
}
OURS = ("neural", "shape-aware")  # the better of which a finish, or a choice, is not to be worse than
WORSE = 1.05
# Flat parts that bend by so little look flat: it is added, lest nothing be infinitely better than hardly anything.
HARDLY = 0.5
# Methods are compared by strain with those that tear no more than this beyond the least, in % of the surface: parts
# that fly apart are not strained at all.
TORN = 5.0
# A triangle that is stretched by this many times what control points ask for between any two of them is torn.
FAR_MORE = 2.0
# A triangle that is strained by more than this counts as strained by this: one that collapses would count for all.
MOST = np.log(10.0)
FOOT = 0.05  # of the longest side: what is no farther from a foot's control point is that foot


@dataclass(frozen=True)
class Result:
    """What a method makes of an edit.

    Attributes
    ----------
    strain : float
        The root of the mean of `(log s1)^2 + (log s2)^2` over the surface, with a triangle's singular values.
    bent : float
        As in `neuralmls_research.metrics.Bends`.
    torn : float
        In % of the surface near contacts, and of the whole: what came apart, and what is stretched by far more than the
        control points ask for.
    gap : float
        The widest opening, in % of the longest side.
    folded : int
        Triangles that turned over against their neighbours.
    handles : float
        How far the worst control point ends from its target, in % of the longest side.
    foot : float
        How far the median of a foot is from where its control point takes it, in % of the way; the worst foot. NaN
        where no foot moves.
    """

    strain: float
    bent: float
    torn: float
    gap: float
    folded: int
    handles: float
    foot: float

    @property
    def spoilt(self) -> float:
        """The root of strain times bending: of what was tried, nearest to what a person sees in the pictures."""
        return float(np.sqrt(self.strain * (self.bent + HARDLY)))


def strained(x: Array, y: Array, faces: Array) -> float:
    """The root mean square of the logarithms of the singular values, weighted by area."""
    values = singular_values(x, y, faces)
    area = np.linalg.norm(normals(x, faces), axis=1)
    kept = np.isfinite(values).all(axis=1)
    with np.errstate(divide="ignore"):
        logs = np.clip(np.log(values[kept]), -MOST, MOST)
    return float(np.sqrt(np.average((logs**2).sum(axis=1), weights=area[kept])))


def result(edit: Edit, bound: Bound, contacts: Contacts, bends: Bends) -> tuple[Array, Result]:
    """Deform the shape, and measure what came of it."""
    x, faces = edit.shape.positions, edit.shape.faces
    y = bound.positions(edit.q)
    tears = contacts.opened(y)
    torn = tears.opened + overstretched(x, y, faces, FAR_MORE * edit.asked)
    at = y[nearest(x, edit.p)] + edit.p - x[nearest(x, edit.p)] if bound.space is None else bound.space(edit.q)(edit.p)
    return y, Result(
        strain=strained(x, y, faces),
        bent=bends.bent(y),
        torn=100 * torn,
        gap=100 * tears.widest,
        folded=flipped_triangles(x, y, faces).count,
        handles=100 * float(np.linalg.norm(at - edit.q, axis=1).max()) / edit.side,
        foot=max((followed(edit, y, foot) for foot in edit.feet), default=np.nan),
    )


def followed(edit: Edit, y: Array, foot: int) -> float:
    """How far the median vertex of a foot is from where its control point takes it, in % of the way."""
    x, way = edit.shape.positions, edit.q[foot] - edit.p[foot]
    away = np.linalg.norm(x - edit.p[foot], axis=1)
    near = away <= max(FOOT * edit.side, float(away.min()))
    return 100 * float(np.median(np.linalg.norm((y - x)[near] - way, axis=1)) / np.linalg.norm(way))


def nearest(x: Array, p: Array) -> Array:
    """The vertex nearest to each control point."""
    return np.array([np.linalg.norm(x - each, axis=1).argmin() for each in p])


class Bench:
    """Methods bound to shapes and control points, once for all edits that share them."""

    def __init__(self, methods: dict[str, Method]) -> None:
        self.methods = methods
        self._bound: dict[tuple[str, int, bytes], Bound] = {}
        self._rest: Callable[[nm.Shape], tuple[Contacts, Bends]] = cache(
            lambda shape: (Contacts(shape.positions, shape.faces), Bends(shape.positions, shape.faces))
        )

    def results(self, edit: Edit) -> dict[str, tuple[Array, Result] | str]:
        """What each method makes of an edit, or why it cannot."""
        found: dict[str, tuple[Array, Result] | str] = {}
        for name, method in self.methods.items():
            key = (name, id(edit.shape), edit.p.tobytes())
            try:
                if key not in self._bound:
                    self._bound[key] = method.bind(edit.shape, edit.p)
                found[name] = result(edit, self._bound[key], *self._rest(edit.shape))
            except nm.NotApplicable as error:
                found[name] = str(error)
        return found


def best(found: dict[str, Result], measure: str) -> float:
    """The least of a measure, of the methods that tear hardly more than they have to."""
    least = min(each.torn for each in found.values())
    return min(getattr(each, measure) for each in found.values() if each.torn <= least + TORN)


def worse(found: dict[str, Result], method: str) -> list[str]:
    """In what a method is worse than the better of `OURS`: by `WORSE`, or by `TORN`."""
    mine, ours = found[method], [found[name] for name in OURS if name in found]
    measures = [
        name for name in ("strain", "spoilt") if getattr(mine, name) > WORSE * min(getattr(each, name) for each in ours)
    ]
    return measures + ["torn"] * (mine.torn > min(each.torn for each in ours) + TORN)


def table(edit: Edit, found: dict[str, tuple[Array, Result] | str]) -> list[str]:
    """The table of an edit."""
    lines = [f"{edit.name} ({len(edit.p)} control points, asks for a stretch of {edit.asked:.2f})"]
    done = results_of(found)
    for name, each in found.items():
        if isinstance(each, str):
            lines.append(f"  {name:18} cannot: {each}")
            continue
        cells = [f"{field.name} {getattr(each[1], field.name):.3g}" for field in fields(Result)]
        against = [f"{what} {getattr(each[1], what) / best(done, what):.2f}" for what in ("strain", "spoilt")]
        lines.append(f"  {name:18} {', '.join(cells)}; of the best: {', '.join(against)}")
    return lines


def results_of(found: dict[str, tuple[Array, Result] | str]) -> dict[str, Result]:
    """Of the methods that could do an edit."""
    return {name: each[1] for name, each in found.items() if not isinstance(each, str)}


def summary(everything: dict[str, dict[str, Result]], methods: list[str]) -> list[str]:
    """What each method makes of the edits that it can do: geometric means against the best method of each edit."""
    lines = [f"{len(everything)} edits"]
    for method in methods:
        mine = {name: found[method] for name, found in everything.items() if method in found}
        if not mine:
            continue
        cells = [f"can do {len(mine)}"]
        for measure in ("strain", "spoilt"):
            ratios = [getattr(each, measure) / best(everything[name], measure) for name, each in mine.items()]
            cells.append(f"{measure} {np.exp(np.log(ratios).mean()):.3f} of the best (at most {max(ratios):.2f})")
        cells.append(f"torn {np.mean([each.torn for each in mine.values()]):.2f} %")
        cells.append(f"folded {sum(each.folded for each in mine.values())}")
        cells.append(f"handles at most {max(each.handles for each in mine.values()):.2g} %")
        feet = [each.foot for each in mine.values() if np.isfinite(each.foot)]
        cells.append(f"feet {np.median(feet):.2g} % in the median, at most {max(feet):.2g} %" if feet else "no feet")
        lines.append(f"  {method:18} {', '.join(cells)}")
        if any(name in found for found in everything.values() for name in OURS):
            broken = {name: worse(everything[name], method) for name in mine}
            for measure in ("strain", "spoilt", "torn"):
                names = [name for name, measures in broken.items() if measure in measures]
                lines.append(f"    {measure} more than the better of {' and '.join(OURS)}: {len(names)} edits {names}")
    return lines


def picture(edit: Edit, found: dict[str, tuple[Array, Result] | str], path: Path) -> None:
    """Draw a row: at rest, and what each method makes of it."""
    from neuralmls.figures.render import Panel, render

    faces = edit.shape.faces
    panels = [Panel(edit.name, edit.shape.positions, faces)]
    panels += [Panel(name, each[0], faces) for name, each in found.items() if not isinstance(each, str)]
    azimuth = 60.0 if np.ptp(edit.shape.bounds, axis=0).argmax() == 0 else 32.0
    render(panels, path, control_points=nm.ControlPoints(edit.p, edit.q), width=520 * len(panels), azimuth=azimuth)


def main() -> None:
    """Print the tables, and draw the pictures if asked to."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("data", type=Path)
    parser.add_argument("--methods", nargs="+", choices=list(RUN), default=list(RUN))
    parser.add_argument("--only", default="", metavar="NAME", help="only edits that have this in their name")
    parser.add_argument("--pictures", type=Path, metavar="DIR", help="draw a row of pictures for each edit")
    given = parser.parse_args()
    bench = Bench({name: RUN[name] for name in given.methods})
    done: dict[str, dict[str, Result]] = {}
    for edit in edits(given.data, given.only):
        found = bench.results(edit)
        print(*table(edit, found), sep="\n", flush=True)
        done[edit.name] = results_of(found)
        if given.pictures is not None:
            given.pictures.mkdir(parents=True, exist_ok=True)
            picture(edit, found, given.pictures / f"{edit.name.replace(', ', '-').replace(' ', '-')}.png")
    print(*summary(done, given.methods), sep="\n")


if __name__ == "__main__":
    main()
