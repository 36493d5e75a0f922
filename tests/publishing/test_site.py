"""The site of documentation: built without a warning, no dead link, nothing left out, the same bytes each time.

A warning of Sphinx fails its build, and so every test here.
"""

from __future__ import annotations

import json
import re

import pytest

from dampbalance.commands.main import parser
from dampbalance.findings.sentences import SENTENCES
from dampbalance.identification.report import PAGE
from dampbalance.project.wording import with_error
from dampbalance.publishing.site import SiteError, build_site
from folders import ROOT, contents, shared
from publishing.site_case import built, local, project, read_page
from schemas import schema_of

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    return shared(tmp_path_factory, "documentation", built) / "site"


@pytest.fixture(scope="module")
def pages(site):
    """Every page that Sphinx made."""
    return [path for path in sorted(site.rglob("*.html")) if "_static" not in path.parts]


def test_no_link_is_dead(site, pages):
    assert len(pages) > 40
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
    assert local(pages[0], "nowhere.html#x") == (pages[0].parent / "nowhere.html", "x")
    assert local(pages[0], "https://example.org/") is None


def test_nothing_is_loaded_from_elsewhere(site, pages):
    for path in pages:
        remote = [target for target in read_page(path).loaded if local(path, target) is None]
        assert [target for target in remote if not target.startswith("data:")] == []
    elsewhere = r"""@import[^;]*//[^;]*|url\(\s*["']?(?:https?:)?//[^)]*"""
    for style in site.rglob("*.css"):
        assert re.findall(elsewhere, style.read_text(encoding="utf-8")) == [], style


@pytest.mark.parametrize(
    "name",
    ["steady_orbit", "Orbit.W", "balance.direct", "solver.pair", "law.terms.of_harmonics"],
)
def test_functions_of_equations_are_linked(site, name):
    links = read_page(site / "reference/equations.html").links
    assert f"dampbalance.{name}" in {link.partition("#")[2] for link in links}


@pytest.mark.parametrize(
    ("page", "schema"), [("case", "config"), ("study", "study"), ("mapping", "mapping")]
)
def test_every_key_is_on_its_page(site, page, schema):
    text = read_page(site / f"reference/{page}.html").text

    def walk(node):
        for name, child in node.get("properties", {}).items():
            assert re.search(rf"(?:^|[\s.,]){name}(?=[\s.,\[])", text), name
            walk(child)
        for inner in ("items", "additionalProperties"):
            if isinstance(node.get(inner), dict):
                walk(node[inner])

    walk(schema_of(schema))


def test_every_option_is_on_its_page(site):
    text = read_page(site / "reference/commands.html").text
    (commands,) = (action for action in parser()._actions if action.choices)
    for name, command in commands.choices.items():
        assert f"usage: dampbalance {name}" in text
        assert all(option in text for one in command._actions for option in one.option_strings)


@pytest.mark.parametrize(
    "path", ["README.md", "CONTRIBUTING.md", "config/README.md", "config/records/README.md"]
)
def test_every_section_is_shown_somewhere(pages, path):
    """By a paragraph of it: its heading may have become that of a page."""
    everything = " ".join(" ".join(read_page(page).text.split()) for page in pages)
    text = re.sub(r"(?sm)^```.*?^```$", "", (ROOT / path).read_text(encoding="utf-8"))
    for section in re.split("^#+ .*\n", text, flags=re.MULTILINE):
        words = re.findall(r"^[A-Z][\w ]{25,}", section, re.MULTILINE)
        assert not words or " ".join(words[0].split()) in everything, words


def test_what_commands_say_and_write_is_shown(site):
    """The numbers on the pages are those of the documents that the commands wrote, which can be downloaded."""
    for page, place in (("howto/identify", "example/dampbalance-demo"), ("start/case", "case")):
        shown = read_page(site / f"{page}.html").text
        written = (site / f"run/{place}/found/identification.json").read_text(encoding="utf-8")
        fit = json.loads(written)["maximum_likelihood"]
        low, high = fit["F_k_interval_N"]
        assert f"F_k = {with_error(fit['F_k_N'], 0.5 * (high - low))} N, c = " in shown
    assert "leave the clamp as it is" in shown
    found = {path.name for path in (site / "run/case").iterdir()}
    assert {"run1.csv", "mount.yaml", "decide.py"} <= found


def test_the_copy_of_the_report_keeps_the_links_that_lead_somewhere(site):
    page = read_page(site / "files/report.html")
    assert page.links == ["#top"]
    assert "taken away" in page.text


def test_studies_show_what_came_out(site):
    page = read_page(site / "studies.html")
    studies = [*(ROOT / "config/studies").glob("*.yaml")]
    assert page.text.count("It shows this.") == len(studies)
    assert len([one for one in page.loaded if "figure" in one]) == len(studies)
    assert "quantity" not in page.text  # the tables are long


def test_each_symptom_can_be_led_to(site):
    page = read_page(site / f"{PAGE}.html")
    sections = {one.page for one in SENTENCES.values() if one.page}
    assert sections <= page.ids
    assert page.text.count("Fault: ") == len(sections)


def test_notebooks_of_the_gallery_have_their_outputs(site):
    shown = {
        name: read_page(site / f"gallery/{name}.html") for name in ("forced", "decay", "study")
    }
    assert "1.28" in shown["forced"].text
    assert "Check: the energy balance differs by" in shown["decay"].text
    for page in shown.values():
        assert len([one for one in page.loaded if one.endswith(".svg")]) >= 2


def test_the_tour_is_a_page_with_its_outputs(site):
    shown = read_page(site / "explain/tour.html").text
    assert "print(6 * 7)" in shown
    assert "42" in shown.split()


def test_the_same_project_gives_the_same_bytes_elsewhere(site, tmp_path):
    build_site(project(tmp_path / "elsewhere"), tmp_path / "site")
    one, other = contents(site), contents(tmp_path / "site")
    assert one.keys() == other.keys()
    assert [name for name in one if one[name] != other[name]] == []
    for name, content in one.items():
        assert str(site.parent).encode() not in content, name


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("[x](nowhere.md)", r"index\.md:3: WARNING"),
        ("```{program-output} dampbalance identify none.csv\n```", "none.csv"),
        ('```{include} ../../README.md\n:start-after: "## No such"\n```', "text not found"),
    ],
)
def test_a_warning_fails_the_build_and_leaves_the_last_site(tmp_path, line, message):
    root = project(tmp_path / "project")
    for page in (root / "paper/site").rglob("*.md"):
        page.unlink()
    text = f"# One page\n\n{line}\n\n```{{toctree}}\nexplain/tour\n```\n"
    (root / "paper/site/index.md").write_text(text, encoding="utf-8")
    (tmp_path / "site").mkdir()
    (tmp_path / "site/index.html").write_text("the last one", encoding="utf-8")
    with pytest.raises(SiteError, match=message):
        build_site(root, tmp_path / "site")
    assert (tmp_path / "site/index.html").read_text(encoding="utf-8") == "the last one"
