"""A run as a small JSON file, to be committed by hand: records/YYYY-MM-DD-<cpu>.json."""

from __future__ import annotations

import json
import re
from dataclasses import asdict
from datetime import UTC, datetime
from pathlib import Path

from benchmarks.machine import Limits
from benchmarks.row import Outcome

FOLDER = Path(__file__).parent / "records"


def write(folder: Path, machine: dict[str, str | int], limits: Limits, outcomes: list[Outcome]) -> Path:
    """Write the record, and return its path."""
    today = datetime.now(UTC).date().isoformat()
    cpu = re.sub(r"[^a-z0-9]+", "-", re.sub(r"\((r|tm)\)", "", str(machine["cpu"]).lower())).strip("-")
    rows = [
        {key: rounded(value) for key, value in (asdict(row) | {"ratio": row.ratio, "met": row.met}).items()}
        for outcome in outcomes
        for row in outcome.rows
    ]
    found = {
        "date": today,
        "machine": machine,
        "limits": {key: rounded(value) for key, value in asdict(limits).items()},
        "rows": rows,
        "answers": [answer for outcome in outcomes for answer in outcome.answers],
        "series": {
            outcome.title: [{key: rounded(value) for key, value in line.items()} for line in outcome.series]
            for outcome in outcomes
            if outcome.series
        },
    }
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"{today}-{cpu}.json"
    path.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
    return path


def rounded(value: object) -> object:
    """Four digits: a time has no more."""
    return float(f"{value:.4g}") if isinstance(value, float) else value
