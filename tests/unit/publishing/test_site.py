"""What the site is made of: sections and links of texts, docstrings, keys of schemas."""

from __future__ import annotations

import html
import re

import docutils.core
import pytest

from dampbalance.publishing.site import pages, reference

TEXT = """\
# Title

Before.

## One

Of [two](#two), [a file](docs/x.md#place) and `[code](not/a/link.md)`.

```
## no heading
[no](link.md)
```

### Inner

![picture](a.svg) and [elsewhere](https://example.org/)

## Two

<!-- kept by a test -->
Last.
"""


def test_a_text_is_cut_at_its_headings_and_not_in_its_code_and_goes_together_again():
    found = pages.sections(TEXT)
    assert [(one.level, one.title, one.anchor) for one in found] == [
        (1, "Title", "title"),
        (2, "One", "one"),
        (3, "Inner", "inner"),
        (2, "Two", "two"),
    ]
    assert "## no heading" in found[1].body
    assert found[3].body == "Last."
    assert [one.title for one in pages.with_inner(found, "One")] == ["One", "Inner"]
    assert pages.with_inner(found, "Three") == []
    assert pages.written(found) == TEXT.replace("<!-- kept by a test -->\n", "")


@pytest.mark.parametrize(
    ("arguments", "shown"),
    [
        ("'One'", ["## no heading", "## Inner"]),
        ("'One', 3", ["### One", "## no heading", "#### Inner"]),
        ("'One', 1, inner=False", ["# One", "## no heading"]),
        ("''", []),
    ],
)
def test_a_section_takes_its_level_on_a_page(tmp_path, arguments, shown):
    for name, text in {"README.md": TEXT, "docs/x.md": "# X\n", "a.svg": "<svg/>"}.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(text)
    (tmp_path / "site").mkdir()
    (tmp_path / "site/page.md").write_text(f'{{{{ section("README.md", {arguments}) }}}}\n')
    page = pages.Pages(tmp_path, "site", {}, tmp_path / "extra").made()["page.md"]
    assert [line for line in page.splitlines() if line.startswith("#")] == shown
    assert ("Before." in page) == (not shown)


def test_links_are_named_from_the_root_on():
    named = pages.of_project(TEXT, "config/records")
    for link in (
        "[a file](project:config/records/docs/x.md#place)",
        "![picture](project:config/records/a.svg)",
        *("[two](#two)", "(https://example.org/)", "`[code](not/a/link.md)`", "[no](link.md)"),
    ):
        assert link in named
    assert pages.of_project("[up](../../README.md)", "config/records") == "[up](project:README.md)"


def test_a_link_to_a_page_has_its_title_and_not_the_name_of_a_folder():
    text = "[`docs/`](x.md), [`docs/x.md`](x.md#y), [words](x.md), [`docs/a.csv`](copied:a.csv), `[a/](x.md)`"
    shown = pages.relinked(text, lambda target, picture: target)
    assert (
        shown == "[](x.md), [](x.md#y), [words](x.md), [`docs/a.csv`](copied:a.csv), `[a/](x.md)`"
    )


def test_output_is_shown_with_numbers_at_the_lines_that_are_explained():
    output = "one   two\n" + "long " * 60
    shown = pages.screen(output, ["^long", "two$"]).splitlines()
    assert shown[0] == "```screen"
    assert shown[1] == "one   two  ②"
    assert shown[-2].endswith("long  ①")
    assert max(map(len, shown)) <= pages.WIDTH


@pytest.mark.parametrize(
    ("title", "anchor"),
    [
        ("How the printed numbers fare", "how-the-printed-numbers-fare"),
        ("What is printed wrongly ✎", "what-is-printed-wrongly-"),
        ("1. One `linear` phase", "1-one-linear-phase"),
    ],
)
def test_the_anchor_of_a_heading(title, anchor):
    assert pages.Section(2, title, "").anchor == anchor


# --- docstrings ----------------------------------------------------------------------------------


INDENTED = """\
It is

    a = 2 ∫ |ẋ| dt      (7a)

    b = x*

and no more.
"""


def shown(docstring):
    """A docstring as HTML; docutils says nothing against its markup."""
    text = "\n".join(reference.markup(docstring.splitlines()))
    settings = {"report_level": 1, "halt_level": 1, "embed_stylesheet": False}
    settings["syntax_highlight"] = "none"
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
    said = html.unescape(re.sub(r"<[^>]*>", "", shown(text)))
    assert said == text.replace("`", "")


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


# --- schemas and commands ------------------------------------------------------------------------

SCHEMA = {
    "type": "object",
    "required": ["hz"],
    "properties": {
        "hz": {"type": "number", "exclusiveMinimum": 0, "description": "Drive\n frequency | f."},
        "levels_m": {
            "type": "array",
            "minItems": 2,
            "items": {"type": "number", "minimum": 0, "maximum": 1e7},
        },
        "phase": {"enum": ["a", "b", "c"]},
        "sets": {
            "type": ["array", "null"],
            "items": {
                "type": "object",
                "properties": {
                    "m_kg": {"$ref": "#/$defs/one"},
                    "c_N_s_per_m": {"$ref": "#/$defs/one"},
                },
            },
        },
        "what": {"registered": "approach"},
    },
    "$defs": {"one": {"type": "integer", "description": "One."}},
}


@pytest.mark.parametrize(
    "line",
    [
        "| `hz` *needed* | number > 0 | Hz | Drive frequency \\| f. |",
        "| `levels_m` | list of 2 or more number from 0 to 1e7 | m |  |",
        "| `phase` | `a`, `b` or `c` |  |  |",
        "| `sets` | list of entries with keys or `null` |  |  |",
        "## `sets[]`",
        "| `m_kg`, `c_N_s_per_m` | whole number | kg, N s/m | One. |",
        "| `what` | `direct` or `X_s` |  |  |",
    ],
)
def test_keys_of_a_schema(line):
    assert line in reference.tables(SCHEMA, {"approach": ["direct", "X_s"]}).splitlines()


def test_every_key_of_a_schema_stands_once_below_what_it_is_inside_of():
    table = reference.tables(SCHEMA, {"approach": ["direct"]})
    found = re.findall(r"^(?:##|\|) `([\w\[\]]+)", table, re.MULTILINE)
    assert " ".join(found) == "hz levels_m phase sets what sets[] m_kg"


@pytest.mark.parametrize(
    ("key", "unit"),
    [
        ("c_3_N_s3_per_m3", "N s³/m³"),
        ("c_2_N_s2_per_m2", "N s²/m²"),
        ("K_z_N_per_m", "N/m"),
        ("poles_rad_per_s", "rad/s"),
        ("step_s", "s"),
        ("hz", "Hz"),
        ("terms", ""),
        ("item", ""),
    ],
)
def test_the_unit_of_a_key_is_the_end_of_its_name(key, unit):
    table = reference.tables({"properties": {key: {"type": "number"}}}, {})
    assert table.splitlines()[2] == f"| `{key}` | number | {unit} |  |"


@pytest.mark.parametrize(("value", "shown"), [(-1e-9, "−1e−9"), (1e12, "1e12"), (250000, "250000")])
def test_bounds_are_written_as_short_as_they_can_be(value, shown):
    table = reference.tables({"properties": {"x": {"type": "number", "minimum": value}}}, {})
    assert f"number ≥ {shown} " in table


def test_names_that_texts_mention():
    text = "`balance.direct`, `motion.orbit.Orbit.W`, `no.such`, `law.law.Law`"  # Orbit is public
    others = {"dampbalance.balance": ["direct"], "dampbalance.law.law": ["Law"]}
    assert reference.others([text], "dampbalance") == others
    assert ":undoc-members:" in reference.directive("dampbalance.Regime")
    function = "dampbalance.steady_orbit"
    assert reference.directive(function) == f".. autofunction:: {function}\n"
    with pytest.raises(LookupError, match=r"dampbalance\.nothing"):
        reference.directive("dampbalance.nothing")


# --- copied files --------------------------------------------------------------------------------


def test_files_are_copied_as_they_lie_with_links_that_lead_somewhere(tmp_path):
    root = tmp_path / "project"
    (root / "a").mkdir(parents=True)
    (root / "a/page.html").write_text(
        '<a href="b.txt#x">b</a><a class="y" href="missing.txt">none</a><a href="#z">z</a>'
        '<a href="https://example.org/">web</a>'
    )
    (root / "a/b.txt").write_text("b")
    site = pages.Pages(root, "", {}, tmp_path / "site")
    assert site.copied("a/page.html") == "files/a/page.html"
    assert site.copied("a/no.txt") is None
    assert site.copied("../secret") is None
    assert (tmp_path / "site/files/a/b.txt").read_text() == "b"
    assert (tmp_path / "site/files/a/page.html").read_text() == (
        '<a href="b.txt#x">b</a><a class="y">none</a><a href="#z">z</a>'
        '<a href="https://example.org/">web</a>'
    )
