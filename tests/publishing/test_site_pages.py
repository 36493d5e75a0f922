"""The pages of the site before it is built: lists that are complete."""

from __future__ import annotations

import pkgutil
import re

import dampbalance
from dampbalance.law.terms import KNOWN_TERMS
from folders import ROOT

SITE = ROOT / "paper/site"


def page(name):
    return (SITE / f"{name}.md").read_text(encoding="utf-8")


def documented(text):
    """The names that a page documents, each with its module."""
    module, names = "", []
    for what, name in re.findall(r"^\.\. (currentmodule|auto\w+):: (\S+)$", text, re.MULTILINE):
        module = name if what == "currentmodule" else module
        names += [f"{module}.{name}"] * (what != "currentmodule")
    return names


def test_public_names_and_functions_of_equations_are_documented():
    public, others = documented(page("reference/api")), documented(page("reference/rooms"))
    assert sorted(public) == sorted(f"dampbalance.{name}" for name in dampbalance.__all__)
    items = [pkgutil.resolve_name(name) for name in [*public, *others]]
    text = (ROOT / "paper/equations.md").read_text(encoding="utf-8")
    for path in set(re.findall(r"`((?:[a-z_]+\.)+\w+)(?:\.\w+)?`", text)):
        try:
            item = pkgutil.resolve_name(f"dampbalance.{path}")
        except (ImportError, AttributeError):
            continue  # a file, or a method of a class
        assert any(item is one for one in items) or not callable(item), path


def test_every_term_is_listed():
    for term in KNOWN_TERMS.values():
        assert f"| `{term.symbol}` | {term.words} | {term.unit} |" in page("howto/laws")
