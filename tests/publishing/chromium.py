"""Where a Chromium is: in the variable CHROMIUM, on the path, or as playwright installs it."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

# Each window would load two pages with suggestions for its address bar: as much work as the page that a test opens.
SUGGESTIONS = ("WebUIOmniboxPopup", "WebUIOmniboxAimPopup")
ARGUMENTS = ["--no-sandbox", "--disable-gpu", f"--disable-features={','.join(SUGGESTIONS)}"]

# First the one without a window, which spares a tenth of the work.
NAMES = (
    "chromium-headless-shell",
    "chromium",
    "chromium-browser",
    "google-chrome",
    "google-chrome-stable",
)


def executable() -> str | None:
    """The path of a Chromium, or None where there is none, or no playwright to drive it."""
    try:
        from playwright.sync_api import sync_playwright
    except ImportError:
        return None
    found = os.environ.get("CHROMIUM") or next(filter(None, map(shutil.which, NAMES)), None)
    if found:
        return found
    with sync_playwright() as playwright:
        own = Path(playwright.chromium.executable_path)
    return str(own) if own.exists() else None


CHROMIUM = executable()
REASON = (
    "no Chromium: apt-get install chromium-headless-shell, or name one in the variable CHROMIUM"
)
