"""Run experiments one after the other, and write their page and their numbers."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from time import perf_counter, process_time
from typing import Any

from neuralmls import __version__
from neuralmls.plugin import write_atomically
from neuralmls_research.experiments.reproduce.formats import write_table
from neuralmls_research.experiments.reproduce.items import Item
from neuralmls_research.experiments.reproduce.lab import Lab
from neuralmls_research.experiments.reproduce.page import page, verdicts
from neuralmls_research.experiments.reproduce.provenance import provenance
from neuralmls_research.experiments.reproduce.report import Report

PAGE, NUMBERS = "index.html", "numbers.json"


def reproduce(
    items: Sequence[Item],
    lab: Lab,
    around: Callable[[str], AbstractContextManager[object]] = lambda _: nullcontext(),
) -> tuple[Path, dict[Item, Report]]:
    """Run the items, and write pictures, tables, page and numbers into the lab's folder.

    Parameters
    ----------
    items : what to run, in this order
    lab : where data is, and where pictures go; the folder is there
    around : a context for each item, by its name: to time it, to show progress

    Returns
    -------
    the page, and what each item gave

    Raises
    ------
    NeuralMLSError
        A library is missing, or a file of the data is broken.
    FileError
        A file cannot be written.
    """
    run: dict[str, Any] = {**provenance(), "seeds": list(lab.seeds), "seconds": {}}
    reports = {}
    for item in items:
        wall, processor = perf_counter(), process_time()
        with around(item.name):
            reports[item] = item.run(lab)
        spent = perf_counter() - wall, process_time() - processor
        run["seconds"][item.name] = {"wall": round(spent[0], 2), "processor": round(spent[1], 2)}
    write_atomically(lab.folder / NUMBERS, (json.dumps({**run, "items": _items(reports)}, indent=1) + "\n").encode())
    for table in [verdicts(reports), *(table for report in reports.values() for table in report.tables)]:
        write_table(table, lab.folder)
    path = lab.folder / PAGE
    write_atomically(path, page(reports, __version__).encode())
    return path, reports


def _items(reports: dict[Item, Report]) -> dict[str, Any]:
    """All that was measured, for machines."""
    return {
        item.name: {
            "title": item.title,
            "setting": report.setting,
            "claims": [claim.for_machines() for claim in report.claims],
            "missing": report.missing,
            "numbers": report.numbers,
        }
        for item, report in reports.items()
    }
