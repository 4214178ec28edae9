"""What `make test` does: one stage after the other, a line for each with its time, and a table at the end.

A stage is a target of the Makefile. What it prints goes to `out/test/TARGET.log`, and to the terminal if it fails,
which ends the run. What a stage left out is told, with the reason.
"""

from __future__ import annotations

import json
import os
import re
import resource
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
LOGS = ROOT / "out" / "test"
PLAYWRIGHT = LOGS / "editor-e2e.json"
STAGES = {
    "rust-format": "Rust: formatting",
    "rust-lint": "Rust: clippy",
    "rust-test": "Rust: tests",
    "rust-simd": "Rust: tests with AVX2, and without SIMD",
    "wasm": "Rust: clippy for WebAssembly",
    "package": "Python: environment and package",
    "editor-build": "editor: build",
    "python-lint": "Python: ruff",
    "python-types": "Python: mypy",
    "python-test": "Python: tests",
    "editor-types": "editor: types",
    "editor-unit": "editor: unit tests",
    "editor-e2e": "editor: tests in Chromium",
    "wheels-build": "wheel: build",
    "wheels-test": "wheel: installed without compilers",
    "fuzz": "fuzzing",
}
# How a stage says what it measured; and how cargo (with --show-output), pytest (with -rs) and vitest say that they
# left something out.
MEASURED = re.compile(r"^measured: .*$", re.MULTILINE)
LEFT_OUT = re.compile(r"^(?:SKIPPED (.*)|skipped: (.*)|test (.* \.\.\. ignored.*)|\s*↓ (.*))$", re.MULTILINE)


@dataclass(frozen=True)
class Ran:
    """How a stage went."""

    passed: bool
    seconds: float
    processor: float
    """Of all its processes."""
    notes: list[str]
    """What it measured, and what it left out."""


def main(targets: list[str]) -> int:
    """Run the stages up to the first that fails."""
    LOGS.mkdir(parents=True, exist_ok=True)
    PLAYWRIGHT.unlink(missing_ok=True)
    ran: dict[str, Ran] = {}
    for target in targets or STAGES:
        print(f"{STAGES[target]} ...", end=" ", flush=True)
        result = ran[target] = run(target)
        print(f"{'passed' if result.passed else 'FAILED'} after {result.seconds:.0f} s", flush=True)
        for line in result.notes:
            print(f"    {line}", flush=True)
        if not result.passed:
            print(log(target).read_text(encoding="utf-8", errors="replace"), file=sys.stderr, flush=True)
            break
    table(ran)
    failed = [target for target, result in ran.items() if not result.passed]
    if failed:
        print(
            f"make test: FAILED in 'make {failed[0]}', see above or {log(failed[0]).relative_to(ROOT)}", file=sys.stderr
        )
        return 1
    print("make test: everything passed")
    return 0


def run(target: str) -> Ran:
    """Run one stage."""
    before, started = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
    environment = {**os.environ, "PLAYWRIGHT_JSON_OUTPUT_FILE": str(PLAYWRIGHT)}
    with log(target).open("wb") as output:
        code = subprocess.run(
            ["make", "--no-print-directory", target],
            cwd=ROOT,
            env=environment,
            stdin=subprocess.DEVNULL,
            stdout=output,
            stderr=subprocess.STDOUT,
            check=False,
        ).returncode
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    processor = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return Ran(code == 0, time.monotonic() - started, processor, list(notes(target)))


def notes(target: str) -> Iterator[str]:
    """What the stage measured, and what it did not check and why."""
    text = re.sub(r"\x1b\[[0-9;]*m", "", log(target).read_text(encoding="utf-8", errors="replace"))
    yield from MEASURED.findall(text)
    for found in LEFT_OUT.finditer(text):
        yield f"left out: {next(filter(None, found.groups()))}"
    if target == "editor-e2e" and PLAYWRIGHT.is_file():
        yield from in_browser(json.loads(PLAYWRIGHT.read_text(encoding="utf-8")))


def in_browser(suite: dict[str, list[dict]]) -> Iterator[str]:
    """What Playwright's report says of tests that were skipped."""
    for inner in suite.get("suites", []):
        yield from in_browser(inner)
    for spec in suite.get("specs", []):
        for test in spec["tests"]:
            if test["status"] == "skipped":
                reasons = [note.get("description") or note["type"] for note in test["annotations"]]
                yield f"left out: {spec['file']}: {spec['title']}: {', '.join(reasons)}"


def log(target: str) -> Path:
    """Where the output of a stage goes."""
    return LOGS / f"{target}.log"


def table(ran: dict[str, Ran]) -> None:
    """How long everything took."""
    rows = [(STAGES[target], f"{one.seconds:.0f} s", f"{one.processor:.0f} s") for target, one in ran.items()]
    total = sum(one.seconds for one in ran.values()), sum(one.processor for one in ran.values())
    rows += [("together", f"{total[0]:.0f} s", f"{total[1]:.0f} s")]
    print(f"\n{'stage':<52}{'time':>8}{'processor':>12}")
    for name, seconds, processor in rows:
        print(f"{name:<52}{seconds:>8}{processor:>12}")


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
