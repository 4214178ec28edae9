"""`python -m benchmarks [--quick] [--only NAME] [--record FOLDER]`."""

from __future__ import annotations

import argparse
import os
import sys
from pathlib import Path

# Before any library starts its threads: the bars are on two.
for _variable in ("RAYON_NUM_THREADS", "OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(_variable, "2")

from rich.console import Console

from benchmarks import definitions, machine, record, table, threads
from benchmarks.rivals import installed
from benchmarks.row import WrongAnswer
from benchmarks.setting import Setting

BUSY = 0.5  # processes that want to run, in the last minute


def main(arguments: list[str] | None = None) -> int:
    """Run the definitions, print the table, write the record; 1 if an answer was wrong, whatever the times."""
    parser = argparse.ArgumentParser(
        prog="benchmarks", description="Times neuralmls and its rivals; checks every answer."
    )
    parser.add_argument("--quick", action="store_true", help="small sizes: whether it works, not how fast")
    parser.add_argument(
        "--only", action="append", choices=definitions.ALL, help="only this definition; may be repeated"
    )
    parser.add_argument(
        "--record", type=Path, help="the folder of the record (quick and partial runs write none without)"
    )
    given = parser.parse_args(arguments)

    console = Console(width=None if sys.stdout.isatty() else 170, highlight=False)
    told = machine.describe()
    console.print(", ".join(f"{key} {value}" for key, value in told.items()))
    if float(told.get("load before", 0)) > BUSY:
        console.print("[yellow]the machine has other work: these times are not its best[/]")
    for rival in ("torch", "molesq"):
        if not installed(rival):
            told_how = f"{rival}: not installed, so that its bars are not held; pip install './research[bench]'"
            console.print(told_how, markup=False)  # or the brackets would be a style
    limits = machine.limits(quick=given.quick)
    console.print(table.limits(limits, threads.THREADS))
    setting = Setting(limits, given.quick)
    outcomes = []
    for name in given.only or definitions.ALL:
        console.print(f"{name} ...")
        try:
            outcomes.append(definitions.ALL[name](setting))
        except WrongAnswer as wrong:
            console.print(f"[bold red]wrong answer[/] in {name}: {wrong}", soft_wrap=True)
            return 1
        for answer in outcomes[-1].answers:
            console.print(f"  {answer}")
    table.show(outcomes, console)
    folder = given.record or (None if given.quick or given.only else record.FOLDER)
    if folder is not None:
        console.print(f"record: {record.write(folder, told, limits, outcomes)}", soft_wrap=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
