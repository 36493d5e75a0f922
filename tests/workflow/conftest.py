"""Copies of the project that the tests of the workflow run in."""

from __future__ import annotations

import fcntl
import os
import shutil
from pathlib import Path

import pytest

from folders import ROOT
from workflow.copies import SMALL, Checkout, copied


@pytest.fixture(scope="module")
def checkout(tmp_path_factory):
    """Makes copies of the project: checkout() -> Checkout."""
    return lambda: copied(ROOT, tmp_path_factory.mktemp("checkout"))


@pytest.fixture(scope="session")
def small(tmp_path_factory) -> Path:
    """The small case with its archive, built on two cores by the first process of the test run that asks for it."""
    top = tmp_path_factory.getbasetemp()
    if "PYTEST_XDIST_WORKER" in os.environ:
        top = top.parent
    folder, complete = top / "small", top / "small.complete"
    with (top / "small.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not complete.exists():
            shutil.rmtree(folder, ignore_errors=True)
            copy = copied(ROOT, folder)
            shutil.copy2(ROOT / "tests/workflow/small.yaml", folder)
            copy.made("archive", *SMALL)
            complete.touch()
    return folder


@pytest.fixture(scope="module")
def built(small, tmp_path_factory) -> Checkout:
    """The small case with its results, a copy for the tests of a module."""
    folder = tmp_path_factory.mktemp("built")
    return copied(small, folder, "small.yaml", "results/small", "results/archive", ".snakemake")
