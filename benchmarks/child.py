"""A command as a process of its own: its seconds and the most memory that it held.

Run as a script, this small process starts the command: the system counts what a process held at most from its
parent's size on, so that a command started from the benchmarks themselves would seem to hold what they do.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter


@dataclass(frozen=True)
class Run:
    """What a process took."""

    seconds: float
    peak: int  # bytes


def run(command: list[str], environment: dict[str, str] | None = None) -> Run:
    """Run a command and wait for it.

    Raises
    ------
    RuntimeError
        It failed; the message is what it said.
    """
    done = subprocess.run(
        [sys.executable, "-I", "-S", str(Path(__file__)), *command],
        capture_output=True,
        text=True,
        env=os.environ | (environment or {}),
    )
    if done.returncode:
        raise RuntimeError(f"{' '.join(command)}: {done.stderr.strip()[-2000:]}")
    seconds, peak = json.loads(done.stdout.splitlines()[-1])
    return Run(seconds, peak)


if __name__ == "__main__":
    start = perf_counter()
    process = subprocess.Popen(sys.argv[1:], stdout=subprocess.DEVNULL)
    _, status, usage = os.wait4(process.pid, 0)
    seconds = perf_counter() - start
    print(json.dumps([seconds, usage.ru_maxrss * (1 if sys.platform == "darwin" else 1024)]))
    sys.exit(os.waitstatus_to_exitcode(status))
