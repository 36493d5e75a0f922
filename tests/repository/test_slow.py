"""Which tests are slow is on record: every entry of slow.txt is a test, and so are marked those that build or start."""

from __future__ import annotations

import ast

import pytest

from folders import ROOT

SLOW = (ROOT / "tests/slow.txt").read_text(encoding="utf-8").split()

STARTING = {"built", "checkout", "small", "browser", "visit"}
"""Fixtures that build a case, or start Snakemake or a browser."""


def test_what_is_listed_is_listed_once_in_order():
    assert sorted({*SLOW}) == SLOW


@pytest.mark.parametrize("file", sorted({name.partition("::")[0] for name in SLOW}))
def test_every_slow_test_is_there(file):
    text = (ROOT / "tests" / file).read_text(encoding="utf-8")
    listed = {name.partition("::")[2] for name in SLOW if name.startswith(f"{file}::")}
    assert (
        listed - {n.name for n in ast.walk(ast.parse(text)) if isinstance(n, ast.FunctionDef)}
        == set()
    )


def test_what_builds_or_starts_something_is_slow(request):
    quick = [
        item.nodeid
        for item in request.session.items
        if STARTING & {*item.fixturenames} and item.get_closest_marker("slow") is None
    ]
    assert quick == []
