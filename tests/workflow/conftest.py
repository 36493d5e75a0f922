"""The cases that tests of the workflow share, built by the first process of the test run that asks for them."""

from __future__ import annotations

from pathlib import Path

import pytest

from folders import ROOT, shared
from workflow.copies import DAILY, EVERY, EXAMPLE, SMALL, Checkout, copied, small_case, summaries


@pytest.fixture
def checkout(tmp_path) -> Checkout:
    """A copy of the project with nothing built."""
    return copied(ROOT, tmp_path / "checkout")


@pytest.fixture(scope="session")
def small(tmp_path_factory) -> Path:
    """The tables of the small case, and two studies of its oscillator."""

    def make(folder: Path) -> None:
        small_case(folder, DAILY).made(*SMALL, "--", "tables", *summaries(DAILY))

    return shared(tmp_path_factory, "small", make)


@pytest.fixture(scope="session")
def example(tmp_path_factory) -> Path:
    """The example of measured records, identified, and in example.txt what was said."""

    def make(folder: Path) -> None:
        said = copied(ROOT, folder).made(*EXAMPLE)
        (folder / "example.txt").write_text(said, encoding="utf-8")

    return shared(tmp_path_factory, "example", make)


@pytest.fixture(scope="module")
def built(small, tmp_path_factory) -> Checkout:
    """The small case with its results, a copy for the tests of a module."""
    return copied(small, tmp_path_factory.mktemp("built"), "small.yaml", "results", ".snakemake")


@pytest.fixture(scope="module")
def whole(built) -> Checkout:
    """The same with figures, page and manifest."""
    built.made(*SMALL)
    return built


@pytest.fixture(scope="session")
def every_study(tmp_path_factory) -> Path:
    """The tables of the small case, and small variants of all shipped studies."""

    def make(folder: Path) -> None:
        small_case(folder, EVERY).made(*SMALL, "--", "tables", "studies")

    return shared(tmp_path_factory, "every_study", make)


@pytest.fixture(scope="module")
def studied(every_study, tmp_path_factory) -> Checkout:
    """A copy of it for the tests of a module."""
    folder = tmp_path_factory.mktemp("studied")
    return copied(every_study, folder, "small.yaml", "results", ".snakemake")
