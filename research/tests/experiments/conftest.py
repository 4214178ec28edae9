"""A real Chromium, and where its screenshots go."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, sync_playwright


@pytest.fixture(scope="session")
def browser() -> Iterator[Browser]:
    """Debian's Chromium, or the one that Playwright brings."""
    programs = ("chromium", "chromium-browser", "google-chrome")
    installed = next(filter(None, map(shutil.which, programs)), None)
    with sync_playwright() as playwright:
        program = installed or playwright.chromium.executable_path
        if not Path(program).exists():
            pytest.skip("no Chromium: apt-get install chromium, or .venv/bin/playwright install chromium")
        running = playwright.chromium.launch(executable_path=program)
        yield running
        running.close()


@pytest.fixture(scope="session")
def pictures() -> Path:
    """The folder `out` of the repository."""
    folder = Path(__file__).resolve().parents[3] / "out"
    folder.mkdir(exist_ok=True)
    return folder
