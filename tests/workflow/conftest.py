"""Copies of the project that the tests of the workflow run in."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from folders import ROOT, shared
from workflow.copies import EXAMPLE, SMALL, Checkout, copied


@pytest.fixture(scope="module")
def checkout(tmp_path_factory):
    """Makes copies of the project: checkout() -> Checkout."""
    return lambda: copied(ROOT, tmp_path_factory.mktemp("checkout"))


@pytest.fixture(scope="session")
def small(tmp_path_factory) -> Path:
    """The small case, built on two cores by the first process of the test run that asks for it."""

    def make(folder: Path) -> None:
        copy = copied(ROOT, folder)
        shutil.copy2(ROOT / "tests/workflow/small.yaml", folder)
        copy.made(*SMALL)

    return shared(tmp_path_factory, "small", make)


@pytest.fixture(scope="session")
def example(tmp_path_factory) -> Path:
    """The example of measured records, identified, and in example.txt what was said, by the first process that asks."""

    def make(folder: Path) -> None:
        said = copied(ROOT, folder).made(*EXAMPLE)
        (folder / "example.txt").write_text(said, encoding="utf-8")

    return shared(tmp_path_factory, "example", make)


@pytest.fixture(scope="module")
def built(small, tmp_path_factory) -> Checkout:
    """The small case with its results, a copy for the tests of a module."""
    folder = tmp_path_factory.mktemp("built")
    return copied(small, folder, "small.yaml", "results/small", ".snakemake")
