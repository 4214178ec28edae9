"""`neuralmls demo`: a chair with longer legs and a leaning back, by neural and by classic weights."""

from __future__ import annotations

import sys
from pathlib import Path
from shlex import quote
from time import perf_counter

import click

from neuralmls.cli import console, options, outputs
from neuralmls.cli.sample import sample_files, write_sample
from neuralmls.errors import FileError, NeuralMLSError
from neuralmls.settings import WeightsName

RESULTS: dict[str, WeightsName] = {"neural": "neural", "classic": "inverse-distance"}


@click.command()
@click.option("--output", "-o", type=options.PATH, default=Path("out"), help="The folder to write into.")
@options.force
def demo(*, output: Path, force: bool) -> None:
    """Bend a sample chair with neural and classic weights.

    Its legs get longer, its back leans; the control points arrive, as `neuralmls deform` has it.
    Writes the shapes and a picture of them.
    """
    outputs.make_folder(output)
    chair, picture = output / "chair.obj", output / "chair.png"
    deformed = {name: output / f"chair-{name}.obj" for name in RESULTS}
    for file in (*sample_files(chair), *deformed.values(), picture):
        outputs.check_output(file, force=force)
    points = sample_files(chair)[2]

    from neuralmls.session import Session
    from neuralmls.shape import read

    write_sample("chair", chair)
    source, session = read(chair), Session.read(points)
    control_points = session.points
    said = [(str(chair), "the chair as it is"), (str(points), f"its {len(control_points)} control points and targets")]
    for name, kind in RESULTS.items():
        start = perf_counter()
        map = session.replace(weights=kind).fit(source)
        positions, maps = map.frame(map.bind(source), return_maps=source.has_normals)
        source.write(deformed[name], positions, maps=maps)
        handles = "onto" if map.report(source).handles == "exact" else "near"
        said.append(
            (str(deformed[name]), f"bent with {name} weights, {handles} all targets, {perf_counter() - start:.2f} s")
        )
    missing = None
    try:
        _draw([chair, *deformed.values()], points, picture)
        said.append((str(picture), "all three side by side: look here first"))
    except FileError:
        raise
    except NeuralMLSError as error:  # no PyVista, or nothing to draw with
        missing = str(error)
    console.pairs(said, sys.stdout)
    if missing is not None:
        console.warning(f"there is no picture: {missing}")
    print("\nTry next:")
    mine = output / "mine.obj"
    console.line(
        f"  neuralmls deform {quote(str(chair))} --points {quote(str(points))} -o {quote(str(mine))} \\", sys.stdout
    )
    console.line(f"    --move {control_points.names[0]}=0,-0.2,0", sys.stdout)
    console.line(f"  neuralmls inspect {quote(str(chair))}", sys.stdout)
    print("  neuralmls points YOUR_SHAPE -o points.json")


def _draw(shapes: list[Path], points: Path, picture: Path) -> None:
    from neuralmls.control_points import ControlPoints
    from neuralmls.figures.render import Panel, render
    from neuralmls.samples import make
    from neuralmls.shape import read

    panels, colours = [], make("chair").colours
    for title, path in zip(["source", *RESULTS], shapes, strict=True):
        shape = read(path)
        panels.append(Panel(title, shape.positions, shape.faces, colours=colours))
    render(panels, picture, control_points=ControlPoints.read(points))
