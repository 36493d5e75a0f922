"""Which tests are slow or nightly is on record: every entry of slow.txt and nightly.txt is there, and what builds or
starts something is slow."""

from __future__ import annotations

import re

import pytest

from folders import ROOT

SLOW, NIGHTLY = (
    (ROOT / f"tests/{name}.txt").read_text(encoding="utf-8").split() for name in ("slow", "nightly")
)

STARTING = {"built", "checkout", "small", "browser", "visit"}
"""Fixtures that build a case, or start Snakemake or a browser."""


NEVER_NIGHTLY = (
    "analytic/",
    "motion/",
    "replication/test_claims.py",
    "replication/test_broken_rebuild.py",
    "repository/test_house.py",
)
"""These must hold of every change: claims, the broken rebuild, motion, analytic identities, the order of the house."""


@pytest.mark.parametrize("listed", [SLOW, NIGHTLY], ids=["slow", "nightly"])
def test_what_is_listed_is_listed_once_in_order(listed):
    assert sorted({*listed}) == listed


def test_what_must_always_hold_is_not_left_to_the_night():
    assert [name for name in NIGHTLY if name.startswith(NEVER_NIGHTLY)] == []


def test_every_test_that_is_listed_is_there():
    for file, _, test in (name.partition("::") for name in [*SLOW, *NIGHTLY]):
        text = (ROOT / "tests" / file).read_text(encoding="utf-8")
        assert re.search(rf"^def {test or '.*'}\(", text, re.MULTILINE), f"{file}::{test}"


def test_what_builds_or_starts_something_is_slow(request):
    quick = [
        item.nodeid
        for item in request.session.items
        if STARTING & {*item.fixturenames} and item.get_closest_marker("slow") is None
    ]
    assert quick == []
