"""Settings of the whole test suite."""

from __future__ import annotations

import builtins
import gc
import itertools
import os
import sys
from collections import Counter
from pathlib import Path

import hypothesis
import pytest

# No test opens a window. Set before matplotlib is imported; pipelines that tests start inherit it.
os.environ["MPLBACKEND"] = "Agg"
# Processes of tests share the processors: threads of linear algebra would wait for each other, for most of the time.
# Set before NumPy is imported.
if "PYTEST_XDIST_WORKER" in os.environ:
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

# The same examples in every run: a failure is a failure for everybody.
# No deadline: the first call of a kernel compiles it.
hypothesis.settings.register_profile(
    "deterministic", derandomize=True, database=None, deadline=None, print_blob=False
)
# To look for new examples: pytest --hypothesis-profile=explore
hypothesis.settings.register_profile("explore", deadline=None, max_examples=2000, print_blob=True)
hypothesis.settings.load_profile("deterministic")


@pytest.fixture(scope="session", autouse=True)
def sum_of_no_floats():
    """Let calls of `sum` in the package fail for floats, as its last bits changed with Python 3.12 (for complex numbers
    with 3.14); use `math.fsum` or `numpy.sum`. A linter does not know which sums are of floats."""
    plain = builtins.sum

    def checked(items, /, start=0):
        caller = sys._getframe(1).f_globals.get("__name__", "")
        if caller.partition(".")[0] == "dampbalance":
            items = [*items]
            if plain(type(item) in (float, complex) for item in items) > 1:
                raise TypeError(f"{caller} adds floats by sum: use math.fsum or numpy.sum")
        return plain(items, start)

    builtins.sum = checked
    yield
    builtins.sum = plain


SLOW = (Path(__file__).parent / "slow.txt").read_text(encoding="utf-8").split()
"""Functions that took 0.4 s in one case, or 2 s in all, when they were last measured; one that is missing is named
at the end of a long run. Files whose fixtures build or start something mark themselves."""


NIGHTLY = (Path(__file__).parent / "nightly.txt").read_text(encoding="utf-8").split()
"""Tests that take long and rarely break: `make night` runs them, and all that needs a browser or SLURM."""


def function_of(nodeid: str) -> str:
    """A test as it stands in slow.txt: without its case."""
    return nodeid.partition("[")[0].removeprefix("tests/")


def pytest_xdist_auto_num_workers():
    """Two processes more than there are processors: browsers, clusters, builds and other programs are waited for."""
    return len(os.sched_getaffinity(0)) + 2 if hasattr(os, "sched_getaffinity") else None


@pytest.hookimpl(wrapper=True)
def pytest_collection():
    """Collect seven thousand tests without looking for garbage among them, which takes as long as all else, and leave
    them out of every later search."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.freeze()
        gc.enable()


def pytest_collection_modifyitems(items):
    """Mark what slow.txt names as slow, by computing alone. Run slow tests first, those of the workflow before all
    others, so that no process ends with one of them alone."""
    for item in items:
        if function_of(item.nodeid) in SLOW:
            item.add_marker("slow")
            item.add_marker("computing")
        item.user_properties.append(("slow", item.get_closest_marker("slow") is not None))
    items.sort(
        key=lambda item: (
            item.get_closest_marker("slow") is None,
            item.path.parent.name != "workflow",
        )
    )
    for item in items:
        needed = OPTIONAL.keys() & set(item.fixturenames)
        item.user_properties += [("needs", OPTIONAL[name]) for name in needed]
        name = function_of(item.nodeid)
        dear = needed or DEAR & set(item.fixturenames)
        if dear or name in NIGHTLY or name.partition("::")[0] in NIGHTLY:
            item.add_marker("nightly")


OPTIONAL = {"slurm": "in a real SLURM", "browser": "in a real browser"}
"""Fixture → how a test with it is run. Not every machine has these programs."""

DEAR = {"article"}
"""Fixtures that take a minute: the article with all that it is made of, of which the page is made, too."""

LONG = 120.0  # s of all tests together
UNMARKED = 4.0  # s, twice what makes a test slow: a busy machine is no reason to mark it

CLOSING = pytest.StashKey[list[str]]()


def pytest_terminal_summary(terminalreporter, config):
    """Count the tests that passed with a program that not every machine has, and the skipped tests by reason; name the
    slowest files of a long run."""
    passed, skipped = (terminalreporter.stats.get(name, []) for name in ("passed", "skipped"))
    needed = Counter(
        how for report in passed for name, how in report.user_properties if name == "needs"
    )
    reasons = Counter(report.longrepr[2].removeprefix("Skipped: ") for report in skipped)
    config.stash[CLOSING] = [
        f"{heading}: {'; '.join(f'{count} {what}' for what, count in sorted(counted.items()))}"
        for heading, counted in (("Passed", needed), ("Skipped here, and why", reasons))
        if counted
    ]
    times: Counter[str] = Counter()
    unmarked: Counter[str] = Counter()
    for report in itertools.chain.from_iterable(terminalreporter.stats.values()):
        if isinstance(report, pytest.TestReport):
            times[report.nodeid.partition("::")[0]] += report.duration
            if ("slow", False) in report.user_properties:
                unmarked[function_of(report.nodeid)] += report.duration
    if sum(times.values()) > LONG:
        config.stash[CLOSING].append(f"The slowest files, with what they wait for: {_list(times)}")
        if slow := Counter({name: taken for name, taken in unmarked.items() if taken > UNMARKED}):
            config.stash[CLOSING].append(f"Slow, and not in tests/slow.txt: {_list(slow)}")


def _list(times: Counter[str]) -> str:
    return ", ".join(f"{name} {seconds:.0f} s" for name, seconds in times.most_common(10))


def pytest_unconfigure(config):
    """Print the counts as the last lines of a run: tests with other programs, skipped tests, and what to install."""
    for line in config.stash.get(CLOSING, []):
        print(line)
