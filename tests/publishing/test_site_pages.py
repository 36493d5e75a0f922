"""The pages of the site before it is built: lists that are complete, links of included texts, docstrings, keys."""

from __future__ import annotations

import html
import pkgutil
import re
import sys
from importlib import import_module
from types import SimpleNamespace

import docutils.core
import pytest
from docutils.utils import Reporter

import dampbalance
from dampbalance.law.terms import KNOWN_TERMS
from folders import ROOT

SITE = ROOT / "paper/site"
sys.path.append(str(SITE))  # where Sphinx finds them, too
docstrings, extension = map(import_module, ("docstrings", "extension"))


def page(name):
    return (SITE / f"{name}.md").read_text(encoding="utf-8")


def documented(text):
    """The names that a page documents, each with its module."""
    module, names = "", []
    for what, name in re.findall(r"^\.\. (currentmodule|auto\w+):: (\S+)$", text, re.MULTILINE):
        module = name if what == "currentmodule" else module
        names += [f"{module}.{name}"] * (what != "currentmodule")
    return names


def test_every_public_name_is_documented_once():
    names = documented(page("reference/api"))
    assert sorted(names) == sorted(f"dampbalance.{name}" for name in dampbalance.__all__)


def test_every_function_that_the_equations_name_is_documented():
    names = documented(page("reference/rooms"))
    assert all(pkgutil.resolve_name(name) is not None for name in names)
    items = [pkgutil.resolve_name(name) for name in [*names, *documented(page("reference/api"))]]
    text = (ROOT / "paper/equations.md").read_text(encoding="utf-8")
    for path in set(re.findall(r"`((?:[a-z_]+\.)+\w+)(?:\.\w+)?`", text)):
        try:
            item = pkgutil.resolve_name(f"dampbalance.{path}")
        except (ImportError, AttributeError):
            continue  # a file, or a method of a class
        assert any(item is one for one in items) or not callable(item), path


def test_every_study_and_every_term_is_listed():
    studies = {path.stem for path in (ROOT / "config/studies").glob("*.yaml")}
    assert {*re.findall(r"\{include\} \S+/studies/(\w+)/summary", page("studies"))} == studies
    for term in KNOWN_TERMS.values():
        assert f"| `{term.symbol}` | {term.words} | {term.unit} |" in page("howto/laws")


@pytest.mark.parametrize("part", ["start", "howto", "explain"])
def test_each_page_of_a_part_has_a_sentence_in_its_index(part):
    listed = re.findall(
        r"^- \[\]\(([\w-]+)\.\w+\): \S.{30,}\.$", page(f"{part}/index"), re.MULTILINE
    )
    others = {file.stem for file in (SITE / part).glob("*.md")} - {"index"}
    assert {*listed} - {"tour"} == others  # the tour is a notebook


def test_included_sections_are_there():
    for file in SITE.rglob("*.md"):
        for path, options in extension._INCLUDE.findall(file.read_text(encoding="utf-8")):
            if "/results/" not in path:
                text = (file.parent / path).resolve().read_text(encoding="utf-8")
                for mark in dict(extension._OPTION.findall(options)).values():
                    assert f"\n{mark}\n" in f"\n{text}", (file.name, mark)


def include(path, *options):
    return "\n".join([f"```{{include}} {path}", *options, "```", ""])


TEXT = """\
# Text

[one](#one), [other](../README.md#use-it), [file](data/x.csv), ![picture](a.svg), [its page](../docs/)
and `[code](not/a/link.md)`, [elsewhere](https://example.org/), [no page](lone.md), [how](../paper/site/a/use.md#x)

## One

```
[no](link.md)
```

### Within

## Two
"""


def test_links_of_an_included_text_lead_to_pages_or_files(tmp_path):
    pages, text = tmp_path / "paper/site", tmp_path / "config/text.md"
    for path, content in {
        "config/text.md": TEXT,
        "README.md": "# Top\n\nAll.\n\n## Use it\n",
        "docs/README.md": "# Docs\n",
        "paper/site/index.md": "# Page\n\n"
        + include("../../README.md", ':start-after: "# Top"', ':end-before: "## Use"'),
        "paper/site/a/one.md": "# A\n\n"
        + include("../../../config/text.md", ':start-after: "## One"', ':end-before: "## Two"'),
        "paper/site/a/use.md": "# B\n\n## Use it\n\n"
        + include("../../../README.md", ':start-after: "## Use it"'),
        "paper/site/docs.md": include("../../docs/README.md"),
    }.items():
        (tmp_path / path).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / path).write_text(content, encoding="utf-8")
    parts = extension.parts_of(pages)
    readme = (tmp_path / "README.md").resolve()
    assert parts[text.resolve(), "one"] == "/a/one.md"
    assert parts[text.resolve(), "within"] == "/a/one.md#within"
    assert (text.resolve(), "two") not in parts
    assert parts[readme, ""] == "/index.md"
    assert parts[readme, "use-it"] == "/a/use.md#use-it"
    app = SimpleNamespace(srcdir=str(pages), env=SimpleNamespace(docname="a/one"))
    content = [TEXT]
    extension._lead_links(app, "../../config/text.md", "one", content)
    for link in (
        *("[one](#one)", "[other](/a/use.md#use-it)", "[file](/../../config/data/x.csv)"),
        *("![picture](/../../config/a.svg)", "[its page](/docs.md)", "`[code](not/a/link.md)`"),
        "[how](/a/use.md#x)",
        *("(https://example.org/)", "[no](link.md)", "[no page](path:/../../config/lone.md)"),
    ):
        assert link in content[0], link


# --- docstrings ----------------------------------------------------------------------------------

INDENTED = """\
It is

    a = 2 ∫ |ẋ| dt      (7a)

    b = x*

and no more.
"""


def shown(docstring):
    """A docstring as HTML; docutils says nothing against its markup."""
    text = "\n".join(docstrings.markup(docstring.splitlines()))
    settings = {"report_level": Reporter.INFO_LEVEL, "halt_level": Reporter.INFO_LEVEL}
    settings |= {"embed_stylesheet": False, "syntax_highlight": "none"}
    parts = docutils.core.publish_parts(text, writer="html5", settings_overrides=settings)
    return " ".join(parts["body"].split())


def test_arguments_on_one_line_or_several_become_a_list():
    made = shown(
        "m : mass, kg, > 0.   c : viscous damping,\nN s/m.\nK_z, F_k : of it, `None` for none."
    )
    terms = [re.sub("<.*?>", "", part.split("</dt>")[0]) for part in made.split("<dt>")[1:]]
    assert terms == ["m", "c", "K_z, F_k"]
    assert "<p>viscous damping, N s/m.</p>" in made


@pytest.mark.parametrize(
    "text", ["|x|, |z| ≤ Z_m and x_ or *p", "a_F_k_ `code_`_", "<b> & \\n", "2 * 3 * 4", "_x_ |a"]
)
def test_text_stays_as_it_is_whatever_it_holds(text):
    assert html.unescape(re.sub(r"<[^>]*>", "", shown(text))) == text.replace("`", "")


@pytest.mark.parametrize(
    ("docstring", "part", "times"),
    [
        ("Raises ValueError for `x < 0`.", '<span class="docutils literal">', 2),
        ("If so, *never* else.", "<em>never</em>", 1),
        (INDENTED, "a = 2 ∫ |ẋ| dt (7a) b = x*", 1),
        (INDENTED, "<pre", 1),
        (INDENTED, "<p>and no more.</p>", 1),
        ("So:\n\n>>> 1 + 1\n2\n", "&gt;&gt;&gt; 1 + 1 2", 1),
    ],
)
def test_code_emphasis_equations_and_examples_are_set(docstring, part, times):
    assert shown(docstring).count(part) == times


# --- keys ----------------------------------------------------------------------------------------


def test_every_key_of_a_schema_stands_once_below_what_it_is_inside_of():
    one = {"$ref": "#/$defs/one"}
    schema = {
        "required": ["hz"],
        "properties": {
            "hz": {"type": "number", "description": "Drive\n frequency | f."},
            "phase": {"enum": ["a", "b"]},
            "sets": {"type": ["array", "null"], "items": {"properties": {"m": one, "c": one}}},
            "named": {"additionalProperties": {"properties": {"sign": {"const": 1}}}},
            "some": {"anyOf": [{"type": "null"}, {"registered": "approach", "also": ["all"]}]},
        },
        "$defs": {"one": {"type": "integer", "description": "One."}},
    }
    rows = list(extension.keys_of(schema, schema))
    assert rows[:5] == [
        ("`hz` *needed*", "number", r"Drive frequency \| f."),
        ("`phase`", "`a`, `b`", ""),
        ("`sets`", "array or null", ""),
        ("`sets[].m`, `c`", "integer", "One."),
        ("`named`", "any value", ""),
    ]
    assert rows[5][:2] == ("`named.*.sign`", "`1`")
    assert rows[6][1].startswith("null or `direct`, `")
    assert rows[6][1].endswith(", `all`")
