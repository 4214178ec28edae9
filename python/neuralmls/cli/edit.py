"""`neuralmls edit`: the browser editor, with a shape already open."""

from __future__ import annotations

from pathlib import Path

import click

from neuralmls.cli import console, inputs, options
from neuralmls.errors import ArgumentError


@click.command()
@click.argument("shape", type=options.PATH, required=False)
@click.option("--points", type=options.PATH, help="Control points or a session to start from, JSON or CSV.")
@click.option("--port", type=click.IntRange(1, 65535), help="Where to listen; without it at 8417, or any that is free.")
@click.option("--browser/--no-browser", default=True, help="Open the browser.")
def edit(*, shape: Path | None, points: Path | None, port: int | None, browser: bool) -> None:
    """Edit a shape in the browser. Nothing leaves this machine.

    Serves the editor, the shape and its materials on 127.0.0.1, until Ctrl-C.

    Example: neuralmls edit chair.obj --points chair.points.json
    """
    import webbrowser

    from neuralmls.editor_server import EditorServer, Session

    session = None
    if shape is not None:
        source = inputs.read_shape(shape)
        if points is not None:
            for sentence in inputs.check_points(inputs.read_session(points).points, points, source):
                console.warning(sentence)
        session = Session(shape, source.companions, points)
    elif points is not None:
        raise ArgumentError("--points: expected a shape that they belong to")

    with EditorServer(session, port=port) as server:
        console.line(f"neuralmls: the editor is at {server.url} until Ctrl-C")
        if browser and not webbrowser.open(server.url_once()):
            console.line("neuralmls: no browser could be opened here: open that address in one")
        try:
            server.serve_forever()
        except KeyboardInterrupt:  # which is how this command ends
            console.line("neuralmls: stopped")
