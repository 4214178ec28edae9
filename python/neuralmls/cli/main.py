"""The entry point: runs a command, and says what went wrong in one sentence."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from contextlib import suppress

import typer
from typer.main import get_command

from neuralmls.cli import console
from neuralmls.cli.deform import deform
from neuralmls.cli.demo import demo
from neuralmls.cli.edit import edit
from neuralmls.cli.inspect import inspect
from neuralmls.cli.points import points
from neuralmls.cli.render import render
from neuralmls.cli.sample import sample
from neuralmls.errors import ArgumentError, NeuralMLSError

BAD_DATA, WRONG_USE, INTERRUPTED = 1, 2, 130

# All of typer's usage errors are of this class; where it is to be imported from differs between typer's versions.
UsageError: type[Exception] = typer.BadParameter.__mro__[1]

# Plain help: it starts at once, and is as wide as the terminal wants it.
app = typer.Typer(
    name="neuralmls",
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100},
)
for command in (deform, edit, inspect, points, render, sample, demo):
    app.command()(command)


def _version(asked: bool) -> None:
    if asked:
        from neuralmls import __version__

        print(f"neuralmls {__version__}")
        raise typer.Exit


@app.callback(epilog="Start with: neuralmls demo")
def neuralmls(
    version: bool = typer.Option(False, "--version", callback=_version, is_eager=True, help="Show the version."),
) -> None:
    """Bend any 3D shape by a few control points; everything else in its file stays as it was."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return its exit code: 0, 1 for bad data, 2 for wrong use, 130 when interrupted."""
    given = list(sys.argv[1:] if arguments is None else arguments) or ["--help"]
    for stream in (sys.stdout, sys.stderr):
        with suppress(AttributeError, ValueError):  # a terminal that cannot show a name still shows the rest
            stream.reconfigure(errors="backslashreplace")  # type: ignore[union-attr]
    command = get_command(app)
    try:
        with command.make_context("neuralmls", given) as context:
            command.invoke(context)
        sys.stdout.flush()
        return 0
    except typer.Exit as done:
        return done.exit_code
    except ArgumentError as error:
        console.error(str(error))
        return WRONG_USE
    except NeuralMLSError as error:
        console.error(str(error))
        return BAD_DATA
    except UsageError as error:
        console.error(_usage(error))
        return WRONG_USE
    except KeyboardInterrupt:
        console.line("neuralmls: interrupted")
        return INTERRUPTED
    except MemoryError:
        console.error("there is not enough memory for this")
        return BAD_DATA
    except OSError as error:  # files are refused where they are read and written: this is standard output
        if not isinstance(error, BrokenPipeError):  # which is how `| head` ends a command
            console.error(f"standard output: cannot write: {error.strerror or error}")
        with suppress(OSError, ValueError):
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # or Python complains at its end
        return BAD_DATA


def _usage(error: Exception) -> str:
    """A usage error of typer's as one sentence, with where to read on."""
    sentence = error.format_message()  # type: ignore[attr-defined]
    sentence = " ".join(sentence.replace("Value error, ", "").rstrip(".").split())
    context = getattr(error, "ctx", None)
    path = context.command_path if context is not None else "neuralmls"
    return f"{sentence[:1].lower()}{sentence[1:]}; see {path} --help"
