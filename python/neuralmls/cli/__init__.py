"""The command line `neuralmls`: one module a command. What takes time to import, the commands import when they run."""

from neuralmls.cli.main import main

__all__ = ["main"]
