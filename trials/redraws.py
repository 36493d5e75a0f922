"""How long does the page take to redraw, at every position of every slider of its instruments?

    make redraws                         of the page in results/paper
    make redraws REDRAWS_ARGS="page.html --positions 100"

Each slider is dragged from one end to the other, on a desk and on a phone, a position a frame; where an instrument goes
on computing, it is waited for. What the browser's main thread does for a frame is one task (script, style, layout and
painting): the table holds the times of those tasks in which something was redrawn, on the clock and, less sensitive to
other programs, as processor time. Exit status 1 where 95 % of the tasks of a slider take more than 16 ms on the clock.
"""

from __future__ import annotations

import argparse
import json
import statistics
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from paper.chromium import ARGUMENTS, CHROMIUM, REASON

FRAME = 16.0  # ms
SCREENS: dict[str, dict[str, Any]] = {
    "desk": {"viewport": {"width": 1280, "height": 900}},
    "phone": {"viewport": {"width": 390, "height": 844}, "device_scale_factor": 2},
}
SLIDERS = ".instrument.ready input[type=range]"
DRAG = """async (slider, positions) => {
  const frame = () => new Promise(requestAnimationFrame);
  const root = slider.closest('.instrument');
  const [low, high] = [slider.min, slider.max].map(Number);
  slider.scrollIntoView({ block: 'center' });
  for (let i = 0; i < 20; i += 1) await frame();
  performance.mark('drag starts');
  for (let i = 0; i < positions; i += 1) {
    slider.value = low + (i / (positions - 1)) * (high - low);
    slider.dispatchEvent(new Event('input', { bubbles: true }));
    do await frame(); while (root.matches('.busy'));
  }
  for (let i = 0; i < 2; i += 1) await frame();
  performance.mark('drag ends');
}"""
MARKS = ("drag starts", "drag ends")
CATEGORIES = ["toplevel", "devtools.timeline", "blink.user_timing"]
TASK = "RunTask"  # as Chromium's trace calls a task of a thread
REDRAWN = ("FireAnimationFrame", "Layout")  # what a task holds in which something was drawn anew


def frames(browser: Any, slider: Any, positions: int) -> Iterator[tuple[float, float]]:
    """Drag a slider; of each task that redraws something meanwhile, the times on the clock and of the processor, ms."""
    browser.start_tracing(page=slider.page, categories=CATEGORIES)
    slider.evaluate(DRAG, positions)
    trace = json.loads(browser.stop_tracing())["traceEvents"]
    marks = {e["name"]: e for e in trace if e["name"] in MARKS}
    first, last = (marks[name]["ts"] for name in MARKS)
    there = [
        e
        for e in trace
        if e.get("tid") == marks[MARKS[1]]["tid"]
        and first <= e["ts"] <= last
        and e.get("ph") == "X"
    ]
    for task in (e for e in there if e["name"].endswith(TASK)):
        inside = {e["name"] for e in there if task["ts"] <= e["ts"] < task["ts"] + task["dur"]}
        if inside.issuperset(REDRAWN):
            yield 1e-3 * task["dur"], 1e-3 * task["tdur"]


def percentile(times: list[float]) -> float:
    """What 95 % of the times do not exceed."""
    return statistics.quantiles(times, n=20, method="inclusive")[-1]


def main(arguments: list[str]) -> int:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("page", nargs="?", type=Path, default=Path("results/paper/report.html"))
    parser.add_argument("--positions", type=int, default=40, help="of each slider")
    given = parser.parse_args(arguments)
    if CHROMIUM is None:
        sys.exit(REASON)
    from playwright.sync_api import sync_playwright

    late = False
    heads = ("median", "95 %", "longest")
    print(f"ms {'on the clock':>56}{'processor':>24}")
    print(f"{'screen':8}{'slider':20}{'redraws':>8}", *(f"{head:>7}" for head in 2 * heads))
    with sync_playwright() as player:
        browser = player.chromium.launch(executable_path=CHROMIUM, args=ARGUMENTS)
        for screen, options in SCREENS.items():
            page = browser.new_context(offline=True, reduced_motion="reduce", **options).new_page()
            page.goto(given.page.resolve().as_uri())
            page.wait_for_selector("#integrator.ready", state="attached")
            page.evaluate("for (const one of document.querySelectorAll('.fold')) one.open = true")
            for slider in page.locator(SLIDERS).all():
                both = [*zip(*frames(browser, slider, given.positions), strict=True)]
                name = slider.get_attribute("id")
                late |= percentile(both[0]) > FRAME
                cells = (of(times) for times in both for of in (statistics.median, percentile, max))
                print(
                    f"{screen:8}{name:20}{len(both[0]):8}",
                    *(f"{t:7.1f}" for t in cells),
                    flush=True,
                )
        browser.close()
    return int(late)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
