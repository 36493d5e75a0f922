"""A site built of the project's own texts, with a few made-up results, for tests of its pages."""

from __future__ import annotations

import re
import shutil
from functools import cache
from pathlib import Path
from typing import NamedTuple
from urllib.parse import unquote, urlsplit

import yaml

from dampbalance.publishing.provenance.manifest import files_of
from dampbalance.publishing.site import PAGES, REPORT_PAGE, TOUR, build_site
from folders import PROJECT, ROOT
from publishing.html import Tree

RESULTS = {
    ".svg": '<svg xmlns="http://www.w3.org/2000/svg" width="90" height="60"><path d="M9 50 L80 9"/></svg>\n',
    ".csv": "quantity\nF_k\n",
    ".md": "# TITLE\n\n441 cases.\n\nIt shows *this*.\n\n![it](figure.png)\n\n| quantity |\n|---|\n| F_k |\n",
    ".pdf": "%PDF-1.7\n",
    ".ipynb": (ROOT / "tests/publishing/tour.ipynb").read_text(encoding="utf-8"),
    ".html": (
        '<!DOCTYPE html><html lang="en"><head><title>Page</title></head><body>'
        '<p id="top"><a class="x" href="../studies/frequency/cases.parquet">taken away</a> <a href="#top">up</a></p>'
        "</body></html>\n"
    ),
}
"""Results to which pages lead, by the ends of their names."""


def project(folder: Path) -> Path:
    """A copy of the project without what was built, and with made-up results."""
    for path in files_of(ROOT, PROJECT):
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(ROOT / path, folder / path)
    pages = "".join(page.read_text(encoding="utf-8") for page in (folder / PAGES).rglob("*.md"))
    for path in {REPORT_PAGE, TOUR, *re.findall(r"(?<=\.\./)results/[\w/]+\.\w+", pages)}:
        file = folder / path
        if not file.exists():
            file.parent.mkdir(parents=True, exist_ok=True)
            text, study = RESULTS[file.suffix], folder / f"config/studies/{file.parent.name}.yaml"
            if study.is_file():
                text = text.replace("TITLE", yaml.safe_load(study.read_text("utf-8"))["title"])
            file.write_text(text, encoding="utf-8")
    return folder


def built(folder: Path) -> Path:
    """The site of a copy of the project in that folder."""
    build_site(project(folder / "project"), folder / "site")
    return folder / "site"


class Page(NamedTuple):
    """What a page holds: names of its places, links of its text, what it loads, and its text."""

    ids: set[str]
    links: list[str]
    loaded: list[str]
    text: str


@cache
def read_page(path: Path) -> Page:
    """A page of a site as it lies there."""
    tree = Tree(path.read_text(encoding="utf-8"))

    def all_of(elements, *names):
        return [element[name] for element in elements for name in names if element.get(name)]

    loaded = all_of(tree.named("link"), "href") + all_of(tree.all, "src", "srcset")
    text = "".join(element["text"] for element in tree.all if not element["within"])
    return Page({*all_of(tree.all, "id", "name")}, all_of(tree.named("a"), "href"), loaded, text)


def local(page: Path, target: str) -> tuple[Path, str] | None:
    """(file, place in it) that a link of a page leads to; None for one that leads to an address."""
    parts = urlsplit(target)
    if parts.scheme or parts.netloc:
        return None
    path = (page.parent / unquote(parts.path)).resolve() if parts.path else page
    return path, unquote(parts.fragment)
