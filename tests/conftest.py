"""Settings of the whole test suite."""

from __future__ import annotations

import builtins
import gc
import os
import sys
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


SLOW, NIGHTLY = (
    {*(Path(__file__).parent / f"{name}.txt").read_text(encoding="utf-8").split()}
    for name in ("slow", "nightly")
)
"""Tests that took 0.4 s in one case, or 2 s in all, when they were last measured: functions that compute; files whose
fixtures build or start something mark themselves. And tests that take long and rarely break, which run at night, as
does all that needs a browser, SLURM, or the article with all that it is made of."""

DEAR = {"article", "browser", "slurm"}


def pytest_xdist_auto_num_workers():
    """Two processes more than there are processors: browsers, clusters, builds and other programs are waited for."""
    return len(os.sched_getaffinity(0)) + 2 if hasattr(os, "sched_getaffinity") else None


@pytest.hookimpl(wrapper=True)
def pytest_collection():
    """Collect thousands of tests without looking for garbage among them, which takes as long as all else, and leave
    them out of every later search."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.freeze()
        gc.enable()


def pytest_collection_modifyitems(items):
    """Mark what is on record as slow or nightly. Run slow tests first, those of the workflow before all others, so that
    no process ends with one of them alone."""
    for item in items:
        name = item.nodeid.partition("[")[0].removeprefix("tests/")
        if name in SLOW:
            item.add_marker("slow")
            item.add_marker("computing")
        if DEAR & {*item.fixturenames} or NIGHTLY & {name, name.partition("::")[0]}:
            item.add_marker("nightly")
    items.sort(
        key=lambda item: (
            item.get_closest_marker("slow") is None,
            item.path.parent.name != "workflow",
        )
    )
