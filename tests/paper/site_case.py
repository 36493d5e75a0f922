"""A site built of the project's own texts, with a few made-up results, for tests of its pages."""

from __future__ import annotations

import shutil
from dataclasses import dataclass, field
from functools import cache
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

from dampbalance.commands.main import parser
from dampbalance.publishing.provenance.sources import PROJECT, files_of
from dampbalance.publishing.site.build import build
from folders import ROOT

FIGURE = (
    '<svg xmlns="http://www.w3.org/2000/svg" width="90" height="60"><path d="M9 50 L80 9"/></svg>\n'
)
RESULTS = {
    "paper/report.html": (
        '<!DOCTYPE html><html lang="en"><head><title>Page</title></head><body>'
        '<p id="top"><a href="../../config/config.yaml">kept</a> '
        '<a class="x" href="../studies/frequency/cases.parquet">taken away</a> <a href="#top">up</a></p>'
        "</body></html>\n"
    ),
    "studies/frequency/summary.md": (
        "# Drive frequency\n\n441 cases; varied: omega_over_omega_n.\n\nIt shows *this*.\n\n"
        "![Drive frequency](figure.png)\n\n| quantity |\n|---|\n| F_k |\n"
    ),
    "studies/frequency/summary.csv": "quantity\nF_k\n",
    "studies/frequency/figure.svg": FIGURE,
}


def project(folder: Path, results: bool = True) -> Path:
    """A copy of the project without what was built, and with made-up results."""
    for path in files_of(ROOT, PROJECT):
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(ROOT / path, folder / path)
    for path, text in RESULTS.items() if results else ():
        (folder / "results" / path).parent.mkdir(parents=True, exist_ok=True)
        (folder / "results" / path).write_text(text, encoding="utf-8")
    return folder


def built(folder: Path) -> Path:
    """The site of a copy of the project in that folder."""
    build(project(folder / "project"), folder / "site", parser())
    return folder / "site"


@dataclass
class Page:
    """What a page holds: names of its places, links of its text, and what it loads."""

    ids: set[str] = field(default_factory=set)
    links: list[str] = field(default_factory=list)
    loaded: list[str] = field(default_factory=list)
    text: str = ""


class _Reader(HTMLParser):
    def __init__(self) -> None:
        super().__init__()
        self.page, self.inside = Page(), ""

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        found = dict(attrs)
        self.inside = tag
        self.page.ids |= {found[name] or "" for name in ("id", "name") if name in found}
        if tag in ("a", "link") and (href := found.get("href")):
            (self.page.links if tag == "a" else self.page.loaded).append(href)
        self.page.loaded += [found[name] or "" for name in ("src", "srcset") if name in found]

    def handle_data(self, data: str) -> None:
        if self.inside not in ("script", "style"):
            self.page.text += data


@cache
def read_page(path: Path) -> Page:
    """A page of a site as it lies there."""
    reader = _Reader()
    reader.feed(path.read_text(encoding="utf-8"))
    return reader.page


def local(page: Path, target: str) -> tuple[Path, str] | None:
    """(file, place in it) that a link of a page leads to; None for one that leads to an address."""
    parts = urlsplit(target)
    if parts.scheme or parts.netloc:
        return None
    path = (page.parent / unquote(parts.path)).resolve() if parts.path else page
    return path, unquote(parts.fragment)
