"""Settings of the whole test suite."""

from __future__ import annotations

import builtins
import itertools
import os
import sys
from collections import Counter

import hypothesis
import pytest

# No test opens a window. Set before matplotlib is imported; pipelines that tests start inherit it.
os.environ["MPLBACKEND"] = "Agg"

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


def pytest_collection_modifyitems(items):
    """Run slow tests first, those of the workflow before all others, so that no process ends with one of them alone."""
    items.sort(
        key=lambda item: (
            item.get_closest_marker("slow") is None,
            item.path.parent.name != "workflow",
        )
    )
    for item in items:
        for name in OPTIONAL.keys() & set(item.fixturenames):
            item.user_properties.append(("needs", OPTIONAL[name]))


OPTIONAL = {"slurm": "in a real SLURM", "browser": "in a real browser"}
"""Fixture → how a test with it is run. Not every machine has these programs."""

LONG = 120.0  # s of all tests together

CLOSING = pytest.StashKey[list[str]]()


def pytest_terminal_summary(terminalreporter, config):
    """Count the tests that passed with a program that not every machine has, and the skipped tests by reason; name the
    slowest files of a long run."""
    passed, skipped = (terminalreporter.stats.get(name, []) for name in ("passed", "skipped"))
    needed = Counter(how for report in passed for name, how in report.user_properties)
    reasons = Counter(report.longrepr[2].removeprefix("Skipped: ") for report in skipped)
    config.stash[CLOSING] = [
        f"{heading}: {'; '.join(f'{count} {what}' for what, count in sorted(counted.items()))}"
        for heading, counted in (("Passed", needed), ("Skipped here, and why", reasons))
        if counted
    ]
    times: Counter[str] = Counter()
    for report in itertools.chain.from_iterable(terminalreporter.stats.values()):
        if isinstance(report, pytest.TestReport):
            times[report.nodeid.partition("::")[0]] += report.duration
    if sum(times.values()) > LONG:
        slowest = ", ".join(f"{file} {seconds:.0f} s" for file, seconds in times.most_common(10))
        config.stash[CLOSING].append(f"The slowest files, with what they wait for: {slowest}")


def pytest_unconfigure(config):
    """Print the counts as the last lines of a run: tests with other programs, skipped tests, and what to install."""
    for line in config.stash.get(CLOSING, []):
        print(line)
