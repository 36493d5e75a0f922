"""What axe-core finds wrong with a page for readers who use a keyboard, a screen reader, or eyes unlike ours."""

from __future__ import annotations

from typing import Any

import pytest

OPTIONS = {
    # WCAG 2.2, levels A and AA, which takes in 2.0 and 2.1; and what axe recommends beyond it.
    "runOnly": {
        "type": "tag",
        "values": ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa", "best-practice"],
    },
    "rules": {"target-size": {"enabled": True}},  # 2.5.8, which axe leaves out by default
    "resultTypes": ["violations"],
}
VIEWS = {
    "desktop": {"viewport": {"width": 1280, "height": 900}, "color_scheme": "light"},
    "phone": {"viewport": {"width": 390, "height": 844}, "color_scheme": "dark"},
}
# Everything unfolded, of the tables below drawings the first. Of entries of a list, rows of a table, marks of a drawing
# and boxes that open which are made alike, down to what is empty in them, three stay.
_UNFOLD_AND_THIN = r"""() => {
  for (const one of document.querySelectorAll('details:not(.values)')) one.open = true;
  const values = document.querySelector('.values');
  if (values) values.open = true;
  const counts = new Map();
  for (const one of document.querySelectorAll('tr, li, svg *, [popover]')) {
    const make = one.outerHTML.replace(/>[^<]*[^<\s][^<]*</g, '>x<').replace(/="[^"]+"/g, '=x');
    if (!counts.has(one.parentElement)) counts.set(one.parentElement, {});
    const count = counts.get(one.parentElement);
    count[make] = (count[make] ?? 0) + 1;
    if (count[make] > 3) one.remove();
  }
}"""


def found(browser: Any, address: str) -> list[str]:
    """What axe-core finds on a page with everything unfolded, at desktop width in light and at phone width in dark."""
    wrong = []
    for name, view in VIEWS.items():
        page = browser.new_page(offline=True, reduced_motion="reduce", **view)
        page.goto(address)
        page.evaluate(_UNFOLD_AND_THIN)
        wrong += [f"{name}: {one}" for one in violations(page)]
        page.close()
    return wrong


def violations(page: Any, within: str | None = None) -> list[str]:
    """What axe-core finds on a page of playwright as it stands: rule, place and element.   within : a selector."""
    axe = pytest.importorskip("axe_playwright_python.sync_playwright").Axe()
    return [
        f"{one['id']}: {' '.join(map(str, node['target']))}: {node['html'][:120]}"
        for one in axe.run(page, within, OPTIONS).response["violations"]
        for node in one["nodes"]
    ]
