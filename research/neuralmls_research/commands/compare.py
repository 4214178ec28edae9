"""`neuralmls compare`: one shape and its control points, by every method that applies."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from neuralmls.cli.plugin import Stages, check_inputs, console, options, outputs
from neuralmls.errors import ArgumentError, ControlPointError
from neuralmls_research.commands import settings

if TYPE_CHECKING:
    from neuralmls import ControlPoints, Shape
    from neuralmls_research.experiments.compare import Result


@click.command()
@options.shape
@options.points("The control points and their targets, JSON or CSV.")
@click.option(
    "--kpd", metavar="FILE", type=options.PATH, help="KeypointDeformer's weights for such shapes, .safetensors."
)
@click.option(
    "--methods",
    metavar="NAME,...",
    help="neural,neural-exact,shape-aware,shape-aware-exact,neural-relax,shape-aware-relax,classic,rbf,arap,"
    "arap-from-fit,biharmonic,biharmonic-displacements,keypoint-deformer; all if not given.",
)
@settings.options(alpha=0.5)
@click.option("--output", "-o", metavar="FOLDER", type=options.PATH, help="Write each deformed shape into it.")
@click.option("--picture", type=options.PATH, help="Draw the source and all results, .png.")
@click.option("--scatter", type=options.PATH, help="Draw distortion against control-point error, .png.")
@click.option("--csv", type=options.PATH, help="Write every figure, .csv.")
@options.json
@options.quiet
@options.force
def compare(
    *,
    shape: Path,
    points: Path,
    kpd: Path | None,
    methods: str | None,
    said: dict[str, Any],
    seeds: int,
    output: Path | None,
    picture: Path | None,
    scatter: Path | None,
    csv: Path | None,
    json: bool,
    quiet: bool,
    force: bool,
) -> None:
    """Deform a shape by every method that can, and measure each.

    Neural weights as in the paper; what we add to it: exact handles, weights that know the
    shape, and both; classic weights, thin-plate RBF, ARAP from the shape at rest and from the
    rigid fit, biharmonic weights and displacements, and with --kpd KeypointDeformer. A method that
    cannot do the shape says why. Settings in the file of control points hold where no option says
    otherwise.

    Example: neuralmls compare chair.obj --points chair.json --methods neural,classic --alpha 1
    """
    from neuralmls_research.experiments.methods import KPD, METHODS, with_settings

    known = [*METHODS, *([KPD] if kpd is not None else [])]
    names = known if methods is None else options.names(methods, known)
    chosen = {name: METHODS[name] for name in names if name in METHODS}
    with_settings(chosen, said)  # refused before anything is read
    inputs = [shape, points, *([kpd] if kpd is not None else [])]
    for file, ending in ((picture, "png"), (scatter, "png"), (csv, "csv")):
        if file is not None:
            outputs.check_ending(file, [ending], "a table" if ending == "csv" else "a picture")
            outputs.check_output(file, force=force, inputs=inputs)
    _check_libraries(picture, scatter)
    deformed = {name: output / f"{shape.stem}-{name}{shape.suffix}" for name in names} if output is not None else {}
    if output is not None and output.exists():
        for file in deformed.values():
            outputs.check_output(file, force=force, inputs=inputs)

    from neuralmls import Session, read
    from neuralmls_research.commands import comparison
    from neuralmls_research.experiments.compare import attempt, load_libraries
    from neuralmls_research.experiments.methods import kpd as kpd_method

    source, session = read(shape), Session.read(points)
    control_points = session.points
    available = with_settings(settings.of_session(session, chosen), said)
    if KPD in names and kpd is not None:
        available[KPD] = kpd_method(kpd)
    stages = Stages(quiet=quiet)
    warnings = [*session.notes, *check_inputs(source, control_points, points)]
    if not (control_points.sources != control_points.targets).any():
        raise ControlPointError(f"{points}: no control point is moved, so that there is nothing to compare")
    if scatter is not None and (source.faces is None or source.positions.shape[1] != 3):
        raise ArgumentError(f"--scatter: distortion is that of a surface, and {shape} has no faces")
    if output is not None:
        outputs.make_folder(output)
    if control_points.is_oriented:
        warnings.append("rotations of control points are left out: the other methods have none")
    for sentence in warnings:
        console.warning(sentence)
    load_libraries()
    runs = settings.by_seed({name: available[name] for name in names}, seeds)
    results: dict[str, list[Result]] = {}
    for name, several in runs.items():
        with stages.stage(name) as report:
            results[name] = []
            for number, method in enumerate(several, 1):
                results[name].append(attempt(method, source, control_points.sources, control_points.targets))
                report(number / len(several))
    low, high = source.bounds
    told: dict[str, Any] = {"input": str(shape), "points": str(points), "unit": float((high - low).max()) / 2}
    told |= comparison.document(source, runs, results) | {"files": [], "warnings": warnings}
    for name, file in deformed.items():
        positions = results[name][0].positions
        if positions is not None:
            files, kept = outputs.write_shape(source, file, positions, force=force)
            told["files"] += files
            for sentence in kept:
                console.warning(sentence)
                warnings.append(sentence)
    if csv is not None:
        comparison.write_csv(csv, told["methods"])
    if picture is not None:
        _draw(picture, source, control_points, [several[0] for several in results.values()])
    if scatter is not None:
        comparison.draw_scatter(scatter, results)
    told["files"] += [str(file) for file in (csv, picture, scatter) if file is not None]
    if json:
        console.document(told)
    elif not quiet:
        comparison.show(told, sys.stdout)


def _check_libraries(picture: Path | None, scatter: Path | None) -> None:
    """Refuse pictures that could not be drawn before any work is done."""
    if picture is not None:
        from neuralmls.figures.stage import pyvista_or_refuse

        pyvista_or_refuse()
    if scatter is not None:
        from neuralmls_research.scatter import matplotlib_or_refuse

        matplotlib_or_refuse()


def _draw(path: Path, shape: Shape, points: ControlPoints, results: list[Result]) -> None:
    """Draw the source and all results, in rows."""
    from neuralmls.figures.render import Panel, render

    panels = [Panel("source", shape.positions, shape.faces)]
    panels += [Panel(result.title, result.positions, shape.faces) for result in results if result.positions is not None]
    rows = -(-len(panels) // 4)
    render(panels, path, control_points=points, columns=-(-len(panels) // rows))
