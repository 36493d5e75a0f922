"""The site of documentation: built without a warning, no dead link, nothing left out, the same bytes each time.

A warning of Sphinx fails its build, and so every test here.
"""

from __future__ import annotations

import re

import pytest
import yaml

import dampbalance
from dampbalance.commands.main import parser
from dampbalance.publishing.site.pages import SiteError, build, commands_of, sections, write_pages
from folders import ROOT, contents, restored, shared
from paper.site_case import built, local, project, read_page, with_commands_of

pytestmark = pytest.mark.slow

SPLIT = ("README.md", "CONTRIBUTING.md", "config/README.md", "config/records/README.md")
"""Texts that are shown section by section."""


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    return shared(tmp_path_factory, "documentation", built) / "site"


@pytest.fixture(scope="module")
def pages(site):
    """Every page that Sphinx made."""
    return [path for path in sorted(site.rglob("*.html")) if "_static" not in path.parts]


def test_it_has_its_pages(site):
    for name in ("index", "search", "start/records", "reference/api", "explain/phase", "studies"):
        assert (site / f"{name}.html").is_file()


def test_no_link_is_dead(site, pages):
    dead = []
    for path in pages:
        page = read_page(path)
        for target in page.links + page.loaded:
            found = local(path, target)
            if found is None or target.startswith("data:"):
                continue
            file, place = found
            inside = file.is_file() and file.is_relative_to(site)
            if not inside or (
                place and file.suffix == ".html" and place not in read_page(file).ids
            ):
                dead.append(f"{path.relative_to(site)}: {target}")
    assert dead == []


def test_a_dead_link_would_be_seen(site):
    page = site / "index.html"
    assert local(page, "nowhere.html#x") == (site / "nowhere.html", "x")
    assert local(page, "https://example.org/") is None
    assert not (site / "nowhere.html").exists()
    assert "rebuild-it" not in read_page(site / "start/oscillators.html").ids


def test_nothing_is_loaded_from_elsewhere(site, pages):
    for path in pages:
        remote = [target for target in read_page(path).loaded if local(path, target) is None]
        assert [target for target in remote if not target.startswith("data:")] == []
    for style in site.rglob("*.css"):
        remote = re.findall(
            r"""@import[^;]*//[^;]*|url\(\s*["']?(?:https?:)?//[^)]*""",
            style.read_text(encoding="utf-8"),
        )
        assert remote == [], style


def test_every_public_name_is_on_its_page(site):
    ids = read_page(site / "reference/api.html").ids
    assert {name for name in dampbalance.__all__ if f"dampbalance.{name}" not in ids} == set()


def test_every_function_of_an_equation_is_documented(site):
    """The page of the equations links each of its functions, as far as code spans name functions."""
    links = read_page(site / "reference/equations.html").links
    known = {link.partition("#")[2] for link in links}
    for name in (
        "steady_orbit",
        "Orbit.W",
        "balance.direct",
        "solver.pair",
        "reading.clean.of_record",
        "law.terms.of_harmonics",
    ):
        assert f"dampbalance.{name}" in known


@pytest.mark.parametrize(
    ("page", "schema"),
    [
        ("case", "src/dampbalance/project/schemas/config.schema.yaml"),
        ("study", "src/dampbalance/project/schemas/study.schema.yaml"),
        ("mapping", "src/dampbalance/project/schemas/mapping.schema.yaml"),
    ],
)
def test_every_key_is_on_its_page(site, page, schema):
    html = (site / f"reference/{page}.html").read_text(encoding="utf-8")

    def walk(node):
        for name, child in node.get("properties", {}).items():
            assert f'<span class="pre">{name}</span>' in html, name
            walk(child)
        for inner in ("items", "additionalProperties"):
            if isinstance(node.get(inner), dict):
                walk(node[inner])

    walk(yaml.safe_load((ROOT / schema).read_text(encoding="utf-8")))


def test_every_option_is_on_its_page(site):
    text = read_page(site / "reference/commands.html").text
    for name, command in commands_of(parser()).items():
        assert f"dampbalance {name}" in text
        for option in (option for action in command._actions for option in action.option_strings):
            assert option in text or option in ("-h", "--help")


@pytest.mark.parametrize("path", SPLIT)
def test_every_section_is_shown_somewhere(site, path):
    """By a paragraph of it: its heading may have become that of a page."""
    everything = " ".join(
        " ".join(read_page(page).text.split()) for page in site.rglob("*.html")
    ).replace("’", "'")
    for section in sections((ROOT / path).read_text(encoding="utf-8")):
        words = re.findall(r"^[A-Z][\w ]{25,}", section.body, re.MULTILINE)
        if words:
            assert " ".join(words[0].split()) in everything, section.title


@pytest.mark.parametrize("index", ["start", "howto", "explain"])
def test_each_page_of_a_part_has_a_sentence_in_its_index(index):
    text = (ROOT / f"paper/site/{index}/index.md").read_text(encoding="utf-8")
    others = {page.name for page in (ROOT / "paper/site" / index).glob("*.md")} - {"index.md"}
    assert {*re.findall(r"^- \[\]\((\S+)\): \S.{30,}\.$", text, re.MULTILINE)} == others


def test_what_commands_say_and_write_is_shown(site):
    """The numbers on the pages are those of the documents that the commands wrote, which can be downloaded."""
    for page, place in (("howto/identify", "example/dampbalance-demo"), ("start/case", "case")):
        shown = read_page(site / f"{page}.html").text
        table = (site / f"run/{place}/found/summary.txt").read_text(encoding="utf-8").splitlines()
        (answer,) = (line for line in table if line.startswith("maximum likelihood"))
        assert answer in shown
    case = site / "run/case"
    assert {"run1.csv", "mount.yaml", "decide.py"} <= {path.name for path in case.iterdir()}
    commands = (case / "commands.sh").read_text(encoding="utf-8").splitlines()
    assert all(command in shown for command in commands)
    assert "leave the clamp as it is" in shown


def test_a_page_of_results_keeps_the_links_that_lead_somewhere(site):
    page = read_page(site / "files/results/paper/report.html")
    assert page.links == ["../../config/config.yaml", "#top"]
    assert "taken away" in page.text
    assert (site / "files/config/config.yaml").is_file()


def test_studies_show_what_was_computed_and_how_to_compute_the_others(site):
    page = read_page(site / "studies.html")
    assert "It shows this." in page.text
    assert any("figure" in source and source.endswith(".svg") for source in page.loaded)
    assert "snakemake --cores all results/studies/map/summary.md" in page.text
    assert "snakemake --cores all results/studies/frequency/summary.md" not in page.text


def test_the_same_project_gives_the_same_bytes_elsewhere(site, tmp_path):
    root, again = project(tmp_path / "elsewhere"), tmp_path / "site"
    with with_commands_of(site.parent):
        build(root, again, parser())
    one, other = contents(site), contents(again)
    assert one.keys() == other.keys()
    assert [name for name in one if one[name] != other[name]] == []
    for name, content in one.items():
        assert str(site.parent).encode() not in content, name


def test_the_tour_is_a_page_with_all_its_text_and_code(site):
    shown = read_page(site / "explain/tour.html")
    text = " ".join(shown.text.split())
    cells = re.split(
        r"^# %%(.*)\n", (ROOT / "paper/notebook/tour.py").read_text("utf-8"), flags=re.M
    )
    for head, body in zip(cells[1::2], cells[2::2], strict=True):
        if "[markdown]" not in head:
            assert " ".join(body.split()) in text
            continue
        title = re.search(r"^# #+ (.+)", body, re.M)
        assert not title or title[1] in text
    assert "files/results/paper/notebook/tour.ipynb" in (site / "explain/tour.html").read_text(
        "utf-8"
    )


def test_without_results_it_says_how_to_make_them(site, tmp_path):
    with with_commands_of(site.parent):
        root = project(tmp_path / "project", results=False)
        write_pages(root, tmp_path / "pages", parser())
    index = (tmp_path / "pages/index.md").read_text(encoding="utf-8")
    assert "`make`, then `make docs`" in index
    assert "results/paper/report.html" not in index


@pytest.fixture(scope="module")
def brief(tmp_path_factory):
    """A project without results whose site has one page, that of the equations."""
    root = project(tmp_path_factory.mktemp("brief"), results=False)
    for page in [*(root / "paper/site").rglob("*.md")]:
        if page.name != "equations.md":
            page.unlink()
    return root


@pytest.mark.parametrize(
    ("page", "message"),
    [
        (
            '{{ section("README.md", "No such section") }}',
            r"README.md has no section 'No such section'",
        ),
        ('{{ text("paper/equations.md") }}', r"paper/equations.md is on .* already"),
        ("[x](project:no/such/file.md)", r"a link leads to no/such/file.md"),
        ("{{ nothing }}", r"'nothing' is undefined"),
        ('{{ run("case", "dampbalance identify none.csv --stiffness 1") }}', "none.csv"),
        ('{{ screen("one", ["two"]) }}', "no line of the output matches 'two'"),
    ],
)
def test_a_page_that_cannot_be_made_is_refused(brief, tmp_path, page, message):
    wrong = brief / "paper/site/wrong.md"
    with restored(wrong):
        wrong.write_text(f"# Wrong\n\n{page}\n", encoding="utf-8")
        with pytest.raises(SiteError, match=message) as error:
            build(brief, tmp_path / "site", parser())
    assert "paper/site/" in str(error.value)
    assert not (tmp_path / "site").exists()


def test_a_warning_fails_the_build_and_leaves_the_last_site(tmp_path):
    root = project(tmp_path / "project", results=False)
    for page in (root / "paper/site").rglob("*.md"):
        page.unlink()
    (root / "paper/site/index.md").write_text("# One page\n\n[x](nowhere.md)\n", encoding="utf-8")
    (tmp_path / "site").mkdir()
    (tmp_path / "site/index.html").write_text("the last one", encoding="utf-8")
    with pytest.raises(SiteError, match=r"paper/site/index\.md:3: WARNING"):
        build(root, tmp_path / "site", parser())
    assert (tmp_path / "site/index.html").read_text(encoding="utf-8") == "the last one"
