"""The entry point: runs a command, and says what went wrong in one sentence."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from contextlib import suppress
from importlib import import_module

import click

from neuralmls.cli import console
from neuralmls.errors import ArgumentError, NeuralMLSError
from neuralmls.extras import RESEARCH

BAD_DATA, WRONG_USE, INTERRUPTED = 1, 2, 130

COMMANDS = ("deform", "fit", "edit", "inspect", "points", "render", "sample", "demo")
RESEARCH_COMMANDS = ("compare", "benchmark", "reproduce", "study", "keypoints", "convert-kpd")
PLUGINS = "neuralmls.commands"  # the entry points by which other packages name commands: `plugin.py`


class Commands(click.Group):
    """The commands: each in the module of its name, which is imported when it is asked for; and other packages'."""

    def list_commands(self, _: click.Context) -> list[str]:
        return list(COMMANDS)

    def get_command(self, _: click.Context, name: str) -> click.Command | None:
        if name in COMMANDS:
            command: click.Command = getattr(import_module(f"neuralmls.cli.{name}"), name)
            return command
        return _of_other_package(name)

    def format_commands(self, context: click.Context, formatter: click.HelpFormatter) -> None:
        """Add the names of other packages' commands, which are not imported for that."""
        super().format_commands(context, formatter)
        if found := _other_packages():
            with formatter.section("Commands of other packages"):
                formatter.write_dl([(package, ", ".join(names)) for package, names in found.items()])


def _of_other_package(name: str) -> click.Command | None:
    from importlib.metadata import entry_points

    for entry in entry_points(group=PLUGINS, name=name):
        try:
            command: click.Command = entry.load()
        except (ImportError, AttributeError) as error:
            raise NeuralMLSError(f"the command '{name}' cannot be loaded from {entry.value}: {error}") from error
        return command
    if name in RESEARCH_COMMANDS:
        raise NeuralMLSError(f"the command '{name}' is in a package of its own, which is not installed: {RESEARCH}")
    return None


def _other_packages() -> dict[str, list[str]]:
    """The packages that have commands for us, and the names of these."""
    from importlib.metadata import entry_points

    found: dict[str, list[str]] = {}
    for entry in entry_points(group=PLUGINS):
        if entry.name not in COMMANDS:
            package = entry.dist.name if entry.dist is not None else entry.value
            found.setdefault(package, []).append(entry.name)
    return found


def _version(context: click.Context, _: click.Parameter, asked: bool) -> None:
    if asked:
        from neuralmls import __version__

        print(f"neuralmls {__version__}")
        context.exit()


@click.group(
    cls=Commands,
    epilog="Start with: neuralmls demo",
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100, "show_default": True},
)
@click.option("--version", is_flag=True, callback=_version, is_eager=True, expose_value=False, help="Show the version.")
def neuralmls() -> None:
    """Bend any 3D shape by a few control points; everything else in its file stays as it was."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return its exit code: 0, 1 for bad data, 2 for wrong use, 130 when interrupted."""
    given = list(sys.argv[1:] if arguments is None else arguments) or ["--help"]
    if sys.stdout is None:  # closed by who started us: a result that goes there is refused as one on a full disk
        sys.stdout = os.fdopen(os.open(os.devnull, os.O_RDONLY), "w")
    if sys.stderr is None:
        sys.stderr = open(os.devnull, "w")  # noqa: SIM115 (as long as the process)
    for stream in (sys.stdout, sys.stderr):
        with suppress(AttributeError, ValueError):  # a terminal that cannot show a name still shows the rest
            stream.reconfigure(errors="backslashreplace")  # type: ignore[union-attr]
    try:
        with neuralmls.make_context("neuralmls", given) as context:
            neuralmls.invoke(context)
        sys.stdout.flush()
        return 0
    except click.exceptions.Exit as done:
        return done.exit_code
    except ArgumentError as error:
        console.error(str(error))
        return WRONG_USE
    except NeuralMLSError as error:
        console.error(str(error))
        return BAD_DATA
    except click.UsageError as error:
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


def _usage(error: click.UsageError) -> str:
    """A usage error as one sentence, with where to read on."""
    sentence = " ".join(error.format_message().rstrip(".").split())
    path = error.ctx.command_path if error.ctx is not None else "neuralmls"
    return f"{sentence[:1].lower()}{sentence[1:]}; see {path} --help"
