"""Which tests are slow or nightly is on record: every entry of slow.txt and nightly.txt is there, and what must hold of
every change is not left to the night."""

from __future__ import annotations

import re

import pytest

from folders import ROOT

SLOW, NIGHTLY = (
    (ROOT / f"tests/{name}.txt").read_text(encoding="utf-8").split() for name in ("slow", "nightly")
)
NEVER_NIGHTLY = (
    *("analytic/", "motion/", "replication/test_claims.py"),
    *("replication/test_broken_rebuild.py", "repository/test_house.py"),
)
"""Claims, the broken rebuild, motion, analytic identities, the order of the house."""


@pytest.mark.parametrize("listed", [SLOW, NIGHTLY], ids=["slow", "nightly"])
def test_every_test_that_is_listed_is_there_once_and_in_order(listed):
    assert sorted({*listed}) == listed
    for file, _, test in (name.partition("::") for name in listed):
        text = (ROOT / "tests" / file).read_text(encoding="utf-8")
        assert re.search(rf"^def {test or '.*'}\(", text, re.MULTILINE), f"{file}::{test}"


def test_what_must_always_hold_is_not_left_to_the_night():
    assert [name for name in NIGHTLY if name.startswith(NEVER_NIGHTLY)] == []
