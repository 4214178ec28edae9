"""Which code made a run, and on which machine: what a reader of its numbers needs to repeat them."""

from __future__ import annotations

import os
import platform
import shutil
import subprocess
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

PACKAGES = ("neuralmls", "neuralmls-research", "numpy", "scipy", "libigl", "matplotlib", "pyvista")


def provenance() -> dict[str, Any]:
    """Date, code and machine of a run that begins now.

    Returns
    -------
    dict that JSON can hold
        `date` (UTC, ISO 8601), `version` of the package, `commit` of the checkout it runs from with `changed` (whether
        files differ from it), both None where it is installed without one, and `machine`.
    """
    return {
        "date": datetime.now(UTC).isoformat(timespec="seconds"),
        **code(Path(__file__).parent),
        "machine": machine(),
    }


def code(folder: Path) -> dict[str, Any]:
    """The version, and the commit of the checkout that has this folder's files under version control."""
    commit = _git(folder, "rev-parse", "HEAD") if _git(folder, "ls-files", ".") else None
    changed = None if commit is None else bool(_git(folder, "status", "--porcelain", "--untracked-files=no"))
    return {"version": _version("neuralmls"), "commit": commit, "changed": changed}


def machine() -> dict[str, Any]:
    """Processor, cores, system and versions."""
    return {
        "processor": processor(),
        "cores": os.cpu_count(),
        "system": f"{platform.system()} {platform.release()}, {platform.machine()}",
        "python": platform.python_version(),
        "packages": {name: _version(name) for name in PACKAGES},
    }


def _git(folder: Path, *arguments: str) -> str | None:
    """What Git says, or None where there is no Git, no checkout, or nothing to say."""
    program = shutil.which("git")
    if program is None:
        return None
    done = subprocess.run([program, "-C", str(folder), *arguments], capture_output=True, text=True, check=False)
    return done.stdout.strip() or None if done.returncode == 0 else None


def _version(name: str) -> str | None:
    try:
        return version(name)
    except PackageNotFoundError:
        return None


def processor() -> str:
    """The processor's name: Linux alone keeps it from `platform`."""
    info = Path("/proc/cpuinfo")
    if info.is_file():
        for line in info.read_text().splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    return platform.processor() or platform.machine()
