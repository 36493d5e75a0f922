"""The site of documentation: built without a warning, no dead link, nothing left out, the same bytes each time.

A warning of Sphinx fails its build, and so every test here.
"""

from __future__ import annotations

import json
import re
import sys
from importlib import import_module

import pytest

from dampbalance.findings.sentences import SENTENCES
from dampbalance.identification.report import PAGE, address
from dampbalance.project.wording import with_error
from dampbalance.publishing.site import SiteError, build_site
from folders import ROOT, contents, shared
from publishing.site_case import built, local, project, read_page

pytestmark = pytest.mark.slow
sys.path.append(str(ROOT / "paper/site/symptoms"))
lab = import_module("lab")


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    return shared(tmp_path_factory, "documentation", built) / "site"


@pytest.fixture(scope="module")
def pages(site):
    """Every page that Sphinx made."""
    return [path for path in sorted(site.rglob("*.html")) if "_static" not in path.parts]


def test_no_link_is_dead_and_nothing_loaded_from_elsewhere(site, pages):
    assert len(pages) > 40
    dead = []
    for path in pages:
        page = read_page(path)
        for target in page.links + page.loaded:
            if (found := local(path, target)) is None:  # an address, which may be in a link alone
                outside = target in page.loaded and not target.startswith("data:")
                dead += [f"{path}: {target}"] * outside
                continue
            file, place = found
            shown = place == "" or file.suffix != ".html" or place in read_page(file).ids
            if not (file.is_file() and file.is_relative_to(site) and shown):
                dead.append(f"{path}: {target}")
    assert dead == []
    elsewhere = r"""@import[^;]*//[^;]*|url\(\s*["']?(?:https?:)?//[^)]*"""
    for style in site.rglob("*.css"):
        assert re.findall(elsewhere, style.read_text(encoding="utf-8")) == [], style


def test_pages_show_what_was_computed(site):
    """The numbers on the pages are those of the documents that the commands wrote, which can be downloaded."""
    demo = "example/dampbalance-demo"
    for page, place in (("index", demo), ("howto/identify", demo), ("start/case", "case")):
        written = (site / f"run/{place}/found/identification.json").read_text(encoding="utf-8")
        fit = json.loads(written)["maximum_likelihood"]
        low, high = fit["F_k_interval_N"]
        shown = f"F_k = {with_error(fit['F_k_N'], 0.5 * (high - low))} N, c = "
        assert shown in read_page(site / f"{page}.html").text
    assert (site / "run/case/decide.py").is_file()
    copied = read_page(site / "files/report.html")
    assert copied.links == ["#top"]  # those that lead somewhere
    assert "taken away" in copied.text
    studies = len([*(ROOT / "config/studies").glob("*.yaml")])
    assert read_page(site / "studies.html").text.count("It shows this.") == studies
    symptoms = read_page(site / f"{PAGE}.html")
    sections = {one.page for one in SENTENCES.values()} - {""}
    assert sections <= symptoms.ids
    assert len(re.findall(r"Fault: .*\nSaid: ", symptoms.text)) == len(sections)  # it is named
    for name, said in (("forced", "1.28"), ("decay", "Check: the energy balance differs by")):
        gallery = read_page(site / f"gallery/{name}.html")
        assert said in gallery.text
        assert len([one for one in gallery.loaded if one.endswith(".svg")]) >= 2
    assert "42" in read_page(site / "explain/tour.html").text.split()
    linked = "".join(read_page(site / "reference/equations.html").links)
    assert "#dampbalance.Orbit.W" in linked
    assert "Friction force F_k in slip" in read_page(site / "reference/case.html").text
    assert "--write-mapping" in read_page(site / "reference/commands.html").text


def test_the_same_project_gives_the_same_bytes_elsewhere(site, tmp_path):
    build_site(project(tmp_path / "elsewhere"), tmp_path / "site")
    one, other = contents(site), contents(tmp_path / "site")
    assert one.keys() == other.keys()
    assert [name for name in one if one[name] != other[name]] == []
    assert [name for name in one if str(site.parent).encode() in one[name]] == []


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("[x](nowhere.md)", r"index\.md:3: WARNING"),
        ("```{program-output} dampbalance identify none.csv\n```", "none.csv"),
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


def test_sound_records_show_none_and_their_truth_and_others_lead_to_their_section():
    sound = lab.identified(lab.Fault("none"))
    assert "symptoms.html" not in sound.report()
    for symbol in ("F_k", "c", "K_z"):
        low, high = sound.intervals[symbol]
        # an interval of 95 % may miss it: twice its width does not
        assert abs(getattr(lab.TRUTH, symbol) - 0.5 * (low + high)) < high - low
    assert address("clipped") in lab.identified(lab.FAULTS["clipped"]).report()
