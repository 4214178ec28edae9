"""Where the test data is. It never lies in the repository: its licences differ."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from hypothesis import settings

# The same examples every time: a test that passes here passes elsewhere. HYPOTHESIS_PROFILE=default searches on.
settings.register_profile("repeatable", derandomize=True, deadline=None)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "repeatable"))

BESIDE = Path(__file__).resolve().parents[2] / "shared"


def _folder(variable: str, name: str) -> Path:
    folder = Path(os.environ.get(variable, BESIDE / name))
    if not folder.is_dir():
        pytest.skip(f"no test data: neither ../shared/{name} nor ${variable} is there")
    return folder


@pytest.fixture(scope="session")
def data() -> Path:
    """Real shapes: ../shared/data or $NEURALMLS_DATA."""
    return _folder("NEURALMLS_DATA", "data")


@pytest.fixture(scope="session")
def golden() -> Path:
    """Results of the published code: ../shared/golden or $NEURALMLS_GOLDEN."""
    return _folder("NEURALMLS_GOLDEN", "golden")
