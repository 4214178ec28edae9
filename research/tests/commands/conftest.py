"""The command line in an empty folder: as for the package's own commands."""

from tests.cli.conftest import content, here, process, refused, run, start

__all__ = ["content", "here", "process", "refused", "run", "start"]
