"""The pages of the site before it is built: lists that are complete, and links of included texts."""

from __future__ import annotations

import pkgutil
import re
import sys
from importlib import import_module
from types import SimpleNamespace

import dampbalance
from dampbalance.law.terms import KNOWN_TERMS
from folders import ROOT

SITE = ROOT / "paper/site"
sys.path.append(str(SITE))  # where Sphinx finds it, too
extension = import_module("extension")


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


def test_every_study_term_and_page_is_listed():
    studies = {path.stem for path in (ROOT / "config/studies").glob("*.yaml")}
    assert {*re.findall(r"\{include\} \S+/studies/(\w+)/summary", page("studies"))} == studies
    for term in KNOWN_TERMS.values():
        assert f"| `{term.symbol}` | {term.words} | {term.unit} |" in page("howto/laws")
    for part in ("start", "howto", "explain"):
        index = page(f"{part}/index")
        listed = re.findall(r"^- \[\]\(([\w-]+)\.\w+\): \S.{30,}\.$", index, re.MULTILINE)
        others = {file.stem for file in (SITE / part).glob("*.md")} - {"index"}
        assert {*listed} - {"tour"} == others  # the tour is a notebook


TEXT = """# Text
[one](#one), [other](../README.md#use-it), [file](data/x.csv), [page](../paper/site/a/use.md#x),
`[code](not/a/link.md)`, [elsewhere](https://example.org/), [no page](lone.md)
"""


def test_links_of_an_included_text_lead_to_pages_or_files(tmp_path):
    including = '# B\n\n```{include} ../../../README.md\n:start-after: "# Top"\n```\n'
    files = {"README.md": "# Top\n\n## Use it\n", "paper/site/a/use.md": including}
    for path, content in files.items():
        (tmp_path / path).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / path).write_text(content, encoding="utf-8")
    app = SimpleNamespace(srcdir=str(tmp_path / "paper/site"), env=SimpleNamespace(docname="a/one"))
    content = [TEXT]
    extension._lead_links(app, "../../config/text.md", "one", content)
    for link in (
        *("[one](#one)", "[other](/a/use.md#use-it)", "[file](/../../config/data/x.csv)"),
        *("[page](/a/use.md#x)", "`[code](not/a/link.md)`", "(https://example.org/)"),
        "[no page](path:/../../config/lone.md)",
    ):
        assert link in content[0], link
