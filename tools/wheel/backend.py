"""Maturin, which first makes sure that a wheel gets all that belongs into it (PEP 517)."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import maturin
from maturin import *  # noqa: F403  # its other hooks: those of editable installations among them

ROOT = Path(__file__).resolve().parents[2]
NEEDED = ["python/neuralmls/editor_server/static/index.html", "LICENSE-THIRD-PARTY.txt"]


def build_wheel(*arguments: Any, **options: Any) -> str:
    """Build a wheel; end with a sentence where the editor is not built."""
    check()
    return maturin.build_wheel(*arguments, **options)


def build_sdist(*arguments: Any, **options: Any) -> str:
    """Build a source distribution, from which wheels can be built without Node.js."""
    check()
    return maturin.build_sdist(*arguments, **options)


def check() -> None:
    """End with a sentence if something is missing."""
    missing = [name for name in NEEDED if not (ROOT / name).is_file()]
    if missing:
        sys.exit(
            f"neuralmls: {missing[0]} is missing, without which no wheel is built: 'make wheels' makes all of it, with"
            " Node.js 20 or later; 'pip install --editable .' needs only Rust, but has no editor"
        )


if __name__ == "__main__":
    check()
