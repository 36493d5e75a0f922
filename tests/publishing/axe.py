"""What axe-core finds wrong with a page for readers who use a keyboard, a screen reader, or eyes unlike ours."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path
from typing import Any

from publishing.chromium import CHROMIUM
from publishing.chromium import REASON as NO_CHROMIUM

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
# Of the tables below drawings, which are made alike, the first.
_UNFOLD = """() => {
  for (const one of document.querySelectorAll('details:not(.values)')) one.open = true;
  const values = document.querySelector('.values');
  if (values) values.open = true;
}"""

# Of entries of a list, rows of a table, marks of a drawing and boxes that open which are made alike, down to what is
# empty in them, three stay.
THIN = r"""() => {
  const counts = new Map();
  for (const one of document.querySelectorAll('tr, li, svg *, [popover]')) {
    const make = one.outerHTML.replace(/>[^<]*[^<\s][^<]*</g, '>x<').replace(/="[^"]+"/g, '=x');
    if (!counts.has(one.parentElement)) counts.set(one.parentElement, {});
    const count = counts.get(one.parentElement);
    count[make] = (count[make] ?? 0) + 1;
    if (count[make] > 3) one.remove();
  }
}"""


# Contrast takes axe three times as long as all else. Texts of the same look on the same surfaces have the same: three
# of each are looked at.
_SAMPLE = """() => {
    const CLEAR = 'rgba(0, 0, 0, 0),none,1'; // shows what is below
    const seen = {}, below = new Map([[null, '']]);
    for (const one of document.querySelectorAll('html, html *')) {
        const style = getComputedStyle(one);
        const ground = [style.backgroundColor, style.backgroundImage, style.opacity].join();
        below.set(one, (ground === CLEAR ? '' : ground) + below.get(one.parentElement));
        if (![...one.childNodes].some((part) => part.nodeType === 3 && part.data.trim())) continue;
        const look = [style.color, style.fontSize, style.fontWeight, below.get(one)].join();
        seen[look] = (seen[look] ?? 0) + 1;
        if (seen[look] <= 3) one.setAttribute('data-contrast', '');
    }
}"""


def found(browser: Any, file: Path) -> list[str]:
    """What axe-core finds on a page with everything unfolded, at desktop width in light and at phone width in dark.

    Of its rules contrast alone depends on the scheme, and that on no width: the same colours serve at all of them.
    """
    wrong = []
    for size, scheme in zip(SIZES, ("light", "dark"), strict=True):
        view = opened(browser, file, size, scheme)
        view.evaluate(THIN)
        all_of = violations(view, contrast=False)
        view.evaluate(_SAMPLE)
        all_of += violations(view, "[data-contrast]", only=["color-contrast"])
        wrong += [f"{size}, {scheme}: {one}" for one in all_of]
        view.context.close()
    return wrong


def violations(
    view: Any, within: str | None = None, contrast: bool = True, only: list[str] | None = None
) -> list[str]:
    """What axe-core finds on a page of playwright as it stands: rule, place, element and what is wrong with it.

    within : a selector of what it looks at, in place of the whole page.   contrast : its one rule that takes long.
    only : the rules to ask for, in place of all.
    """
    from axe_playwright_python.sync_playwright import Axe

    rules = OPTIONS["rules"] | {"color-contrast": {"enabled": contrast}}
    asked = OPTIONS | ({"runOnly": only} if only else {"rules": rules})
    found = Axe().run(view, within, asked).response["violations"]
    return [
        f"{one['id']}: {' '.join(map(str, node['target']))}: {node['html'][:120]}"
        for one in found
        for node in one["nodes"]
    ]


def opened(browser: Any, file: Path, size: str, scheme: str) -> Any:
    """The page without network, everything on it that folds unfolded."""
    context = browser.new_context(
        offline=True, color_scheme=scheme, viewport=SIZES[size], reduced_motion="reduce"
    )
    view = context.new_page()
    view.set_default_timeout(120_000)  # a busy machine
    view.goto(file.as_uri())
    view.evaluate(_UNFOLD)
    view.evaluate("scrollTo(0, 0)")
    return view
