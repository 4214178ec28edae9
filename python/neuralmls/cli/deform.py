"""`neuralmls deform`: shapes, control points, and the same files with their shapes bent."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from neuralmls.cli import console, inputs, moves, options, outputs, settings
from neuralmls.cli.stages import Stages
from neuralmls.errors import ArgumentError, FileError, NeuralMLSError

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from neuralmls.arrays import Progress
    from neuralmls.session import Map, Session
    from neuralmls.shape import Shape


@click.command()
@options.shapes
@options.session
@click.option("--map", "saved", type=options.PATH, help="A map that `neuralmls fit` wrote, in the place of a fit.")
@options.output_or_folder("The file to write, of the shape's format, or a folder; - for standard output.")
@settings.settings_options(*settings.WEIGHTS, *settings.MOTION)
@click.option(
    "--move",
    "offsets",
    metavar="NAME=DX,DY,DZ",
    multiple=True,
    help="Move a target, or those of a group, from where the file has it; may be repeated.",
)
@click.option(
    "--turn",
    "turns",
    metavar="NAME=AXIS,DEGREES",
    multiple=True,
    help="Turn a control point, and what is near it, or a group; AXIS is x, y, z or three numbers. May be repeated.",
)
@click.option("--inverse", is_flag=True, help="Undo the map: what was deformed by it comes back.")
@click.option("--check", is_flag=True, help="Say where the result is likely bad, and what would help.")
@options.json
@options.quiet
@click.option("--verbose", is_flag=True, help="Every control point in the summary.")
@options.force
def deform(
    *,
    shapes: Sequence[Path],
    points: Path | None,
    targets: Path | None,
    by_order: bool,
    saved: Path | None,
    output: str,
    said: dict[str, Any],
    offsets: Sequence[str],
    turns: Sequence[str],
    inverse: bool,
    check: bool,
    json: bool,
    quiet: bool,
    verbose: bool,
    force: bool,
) -> None:
    """Bend shapes by control points.

    Writes the same files with new positions. Everything else in them is carried over; unmoved control
    points give the very same bytes. Several shapes are bent by one map, so that they stay together.
    What a session sets (weights, transform, temperature, handles, relax, no_folds) holds where no option says
    otherwise.

    Example: neuralmls deform chair.obj --points chair.json -o bent.obj
    """
    given = [path for path in (*shapes, points, targets, saved) if path is not None]
    inputs.one_standard_input(given)
    files, folder = outputs.of_shapes(shapes, output)
    for file in files:
        outputs.check_output(file, force=force, inputs=given, folder_comes=folder is not None)
    stages, failed = Stages(quiet=quiet), Failed(several=len(shapes) > 1)
    with stages.stage("read"):
        session, ready, notes = _session(points, targets, by_order, saved)
        source = str(points) if points is not None and session.has_settings else None
        session = inputs.settings_of(said, session)
        session = session.replace(points=moves.moved(session.points, offsets, turns))
        ready = None if ready is None else ready.with_session(session)
        if inverse and ready is None:
            _check_undoable(session)
        moved = bool((session.points.targets != session.points.sources).any()) or session.points.is_oriented
        read = []
        for path, file in zip(shapes, files, strict=True):
            with failed:
                shape = _read(path, file, moved=moved, force=force, sized=ready is None and session.frame is None)
                inputs.check_points(session.points, points or saved, shape)
                read.append((shape, file))
    if not read:
        failed.raise_last()
    frame = (session if ready is None else ready.session).frame
    warnings = [*notes, *inputs.check_together(session.points, [shape for shape, _ in read], frame)]
    if not moved:
        warnings.append("no control point is moved, so that the output is the input")
    for sentence in warnings:
        console.warning(sentence)
    if folder is not None:
        outputs.make_folder(folder)
    if ready is None:
        with stages.stage("bind" if session.weights == "inverse-distance" else "train") as report:
            ready = session.fit(*(shape for shape, _ in read), progress=report)
    results = []
    for shape, file in read:
        with failed:
            results.append(_bent(shape, file, ready, stages, inverse=inverse, check=check, force=force))
    for sentence in dict.fromkeys(warning for told in results for warning in told["warnings"]):
        console.warning(sentence)
    _tell(results, stages, warnings, source, json=json, quiet=quiet, verbose=verbose)
    failed.raise_last()


class Failed:
    """Errors of single shapes among several, which do not stop the others; that of a single shape is raised at once."""

    def __init__(self, *, several: bool) -> None:
        self._several = several
        self._errors: list[NeuralMLSError] = []

    def __enter__(self) -> None:
        return None

    def __exit__(self, kind: object, error: BaseException | None, _: object) -> bool:
        if not self._several or not isinstance(error, NeuralMLSError):
            return False
        self._errors.append(error)
        return True

    def raise_last(self) -> None:
        """Say all but the last, and raise that."""
        for error in self._errors[:-1]:
            console.error(str(error))
        if self._errors:
            raise self._errors[-1]


def _session(
    points: Path | None, targets: Path | None, by_order: bool, saved: Path | None
) -> tuple[Session, Map | None, tuple[str, ...]]:
    """The session as files have it, the map that was fitted already, and what reading left out."""
    from neuralmls.session import Map

    if points is None and saved is None:
        raise ArgumentError("--points: expected a file of control points, or a fitted map with --map")
    if points is None and (targets is not None or by_order):
        raise ArgumentError("--points: expected a file of control points, which --targets and --by-order belong to")
    session = None if points is None else inputs.read_session(points, targets, by_order=by_order)
    if saved is None:
        assert session is not None
        return session, None, session.notes
    ready = Map.load(saved)
    if session is None:
        return ready.session, ready, ()
    shared = ("transform", "temperature", "handles", "relax", "no_folds")
    said = {key: session.settings[key] for key in shared if session.has_settings}
    try:
        ready = ready.with_session(ready.session.replace(points=session.points, **said))
    except ArgumentError as error:
        raise ArgumentError(f"{points}, for {saved}: {error}") from None
    return ready.session, ready, session.notes


def _read(path: Path, file: Path, *, moved: bool, force: bool, sized: bool) -> Shape:
    """A shape that can be written to the file; a `sized` one, where weights are to be trained in its box."""
    shape = inputs.read_shape(path, sized=sized)
    if file == outputs.STANDARD_OUTPUT:
        for name in shape.side_files(shape.path.stem):
            raise ArgumentError(
                f"standard output takes one file, but this {shape.format} is written with '{name}' beside it: "
                "name an output file"
            )
        return shape
    outputs.check_ending(file, shape.extensions, f"a bent {shape.format} file (formats are not converted)")
    for name in shape.side_files(file.stem) if moved else ():
        outputs.check_output(file.parent / name, force=force, folder_comes=not file.parent.exists())
    return shape


def _check_undoable(session: Session) -> None:
    """Refuse weights that hang on the shape at rest, which only a map or a frame tells of a deformed one."""
    kind, weights = session.weights, session.settings["weights"]
    framed = session.frame is not None and kind != "shape-aware" and session.settings["relax"] == 0
    if not framed and (kind != "inverse-distance" or weights.get("epsilon")):
        raise ArgumentError(
            "--inverse: the weights hang on the shape at rest, which the deformed one does not tell: "
            "give the map of `neuralmls fit` with --map"
        )


def _bent(
    shape: Shape, file: Path, map: Map, stages: Stages, *, inverse: bool, check: bool, force: bool
) -> dict[str, Any]:
    """Bend one shape, or undo that, and write it; what is to be told of it."""
    from neuralmls.cli import summary

    maps: NDArray[np.float64] | None
    if inverse:
        with stages.stage("move") as report:
            positions, maps = _undone(shape, map, report)
    else:
        with stages.stage("bind") as report:
            bound = map.bind(shape, progress=report)
        with stages.stage("move") as report:
            positions, maps = map.frame(bound, return_maps=shape.has_normals, progress=report)
    told = map.report(shape)
    advice = []
    if check:
        with stages.stage("check"):
            advice = map.advise(positions, shape.faces) if inverse else map.advise(shape)
    with stages.stage("write"):
        written, kept = _write(shape, file, positions, maps, force=force)
    return summary.summary(shape, file, map, told, advice if check else None, written, kept)


def _undone(shape: Shape, map: Map, report: Progress | None) -> tuple[NDArray[np.floating], NDArray[np.float64]]:
    try:
        positions, maps = map.inverse(shape, return_maps=True, progress=report)
    except ArgumentError as error:
        raise ArgumentError(f"--inverse: {shape.path}: {error}") from None
    return positions, maps


def _write(
    shape: Shape, file: Path, positions: NDArray[np.floating], maps: NDArray[np.float64] | None, *, force: bool
) -> tuple[list[str], list[str]]:
    """Write the shape; return the files written, and warnings of others that are kept or missing."""
    try:
        if file != outputs.STANDARD_OUTPUT:
            return outputs.write_shape(shape, file, positions, maps=maps, force=force)
        data, _ = shape.encode(positions, maps=maps)
    except ArgumentError as error:  # numbers that the file's type cannot hold
        raise FileError(f"{shape.path}: {error}") from None
    sys.stdout.buffer.write(data)
    sys.stdout.buffer.flush()
    return [], []


def _tell(
    results: Sequence[dict[str, Any]],
    stages: Stages,
    warnings: Sequence[str],
    source: str | None,
    *,
    json: bool,
    quiet: bool,
    verbose: bool,
) -> None:
    from neuralmls.cli import summary

    to_stdout = any(told["output"] == str(outputs.STANDARD_OUTPUT) for told in results)
    out = sys.stderr if to_stdout else sys.stdout
    for told in results:
        told["warnings"] = [*warnings, *told["warnings"]]
        told["seconds"] = stages.seconds
        told["session"] = source
    if json:
        console.document(results[0] if len(results) == 1 else {"results": list(results)}, out)
    elif not quiet:
        for told in results:
            summary.show(told, everything=verbose, file=out)
