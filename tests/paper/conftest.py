"""A browser for the tests of page and tour."""

from __future__ import annotations

import pytest

from paper.chromium import CHROMIUM, REASON


@pytest.fixture(scope="module")
def browser():
    """A Chromium; the test is skipped where there is none."""
    if CHROMIUM is None:
        pytest.skip(REASON)
    from playwright.sync_api import sync_playwright

    with sync_playwright() as player:
        started = player.chromium.launch(
            executable_path=CHROMIUM, args=["--no-sandbox", "--disable-gpu"]
        )
        yield started
        started.close()
