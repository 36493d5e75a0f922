"""What axe-core finds wrong with a page for readers who use a keyboard, a screen reader, or eyes unlike ours."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path
from typing import Any

from paper.chromium import CHROMIUM
from paper.chromium import REASON as NO_CHROMIUM

MISSING = find_spec("axe_playwright_python") is None
SKIP = MISSING or CHROMIUM is None
REASON = "no axe-core: pip install --group dev" if MISSING else NO_CHROMIUM

OPTIONS = {
    # WCAG 2.2, levels A and AA, which takes in 2.0 and 2.1; and what axe recommends beyond it.
    "runOnly": {
        "type": "tag",
        "values": ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa", "best-practice"],
    },
    "rules": {"target-size": {"enabled": True}},  # 2.5.8, which axe leaves out by default
    "resultTypes": ["violations"],
}
SIZES = {"desktop": {"width": 1280, "height": 900}, "phone": {"width": 390, "height": 844}}
_UNFOLD = "() => document.querySelectorAll('details').forEach((one) => { one.open = true; })"


def found(browser: Any, file: Path) -> list[str]:
    """What axe-core finds on a page with everything unfolded, at desktop and phone width, light and dark."""
    places = [(size, scheme) for size in SIZES for scheme in ("light", "dark")]
    wrong = []
    for size, scheme in places:
        view = opened(browser, file, size, scheme)
        wrong += [f"{size}, {scheme}: {one}" for one in violations(view)]
        view.context.close()
    return wrong


def violations(view: Any) -> list[str]:
    """What axe-core finds on a page of playwright as it stands: rule, place, element and what is wrong with it."""
    from axe_playwright_python.sync_playwright import Axe

    found = Axe().run(view, options=OPTIONS).response["violations"]
    return [
        f"{one['id']}: {' '.join(map(str, node['target']))}: {node['html'][:120]}"
        for one in found
        for node in one["nodes"]
    ]


def opened(browser: Any, file: Path, size: str, scheme: str) -> Any:
    """The page without network, everything on it that folds unfolded, every chart drawn."""
    context = browser.new_context(
        offline=True, color_scheme=scheme, viewport=SIZES[size], reduced_motion="reduce"
    )
    view = context.new_page()
    view.set_default_timeout(120_000)  # a busy machine
    view.goto(file.as_uri())
    view.evaluate(_UNFOLD)
    # A chart is drawn when it comes near: one that a slow machine scrolls past may be missed.
    for plot in view.locator(".plot").all():
        plot.scroll_into_view_if_needed()
        view.wait_for_selector(f"#{plot.get_attribute('id')}.ready")
    view.evaluate("scrollTo(0, 0)")
    return view
