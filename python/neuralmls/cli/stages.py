"""The stages of a long command: timed, and with a bar on a terminal."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import perf_counter
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.progress import Progress as Bars

PATIENCE = 0.4  # seconds; a stage that is done sooner needs no bar


class Stages:
    """Times stages by their name, in `seconds`; shows a bar on standard error where that is a terminal."""

    def __init__(self, *, quiet: bool = False) -> None:
        self.seconds: dict[str, float] = {}
        self._bars = not quiet and sys.stderr.isatty()

    @contextmanager
    def stage(self, name: str) -> Iterator[Callable[[float], None]]:
        """Run one stage, which tells the given function the fraction that is done."""
        start = perf_counter()
        bars: Bars | None = None

        def report(fraction: float) -> None:
            nonlocal bars
            if self._bars and bars is None and perf_counter() - start > PATIENCE:
                bars = _bars()
                bars.add_task(name, total=1.0)
                bars.start()
            if bars is not None:
                bars.update(bars.task_ids[0], completed=fraction)

        try:
            yield report
        finally:
            if bars is not None:
                bars.stop()
            self.seconds[name] = self.seconds.get(name, 0.0) + perf_counter() - start


def _bars() -> Bars:
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeRemainingColumn

    columns = (TextColumn("  {task.description:<8}"), BarColumn(), TaskProgressColumn(), TimeRemainingColumn())
    return Progress(*columns, console=Console(stderr=True), transient=True)
