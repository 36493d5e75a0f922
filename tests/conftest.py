"""Settings of the whole test suite."""

from __future__ import annotations

import os
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


def pytest_collection_modifyitems(items):
    """The slow ones first, and first of all the workflow: no process is left alone with one of them at the end."""
    items.sort(
        key=lambda item: (
            item.get_closest_marker("slow") is None,
            item.path.parent.name != "workflow",
        )
    )


SKIPPED = pytest.StashKey[Counter[str]]()


def pytest_terminal_summary(terminalreporter, config):
    """Count the skipped tests by their reason, which says what to install."""
    reports = terminalreporter.stats.get("skipped", [])
    config.stash[SKIPPED] = Counter(
        report.longrepr[2].removeprefix("Skipped: ") for report in reports
    )


def pytest_unconfigure(config):
    """The last line of a run: what was not checked on this machine, and what would let it be."""
    skipped = config.stash.get(SKIPPED, None)
    if skipped:
        reasons = "; ".join(f"{count} ({why})" for why, count in sorted(skipped.items()))
        print(f"Skipped here, and run in CI or where it can be: {reasons}")
