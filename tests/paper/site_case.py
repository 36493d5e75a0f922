"""A site built of the project's own texts, with a few made-up results, for tests of its pages."""

from __future__ import annotations

import pickle
import shutil
from contextlib import AbstractContextManager
from functools import cache
from pathlib import Path
from typing import NamedTuple
from unittest import mock
from urllib.parse import unquote, urlsplit

from dampbalance.commands.main import parser
from dampbalance.publishing.provenance.manifest import PROJECT, files_of
from dampbalance.publishing.site import pages
from dampbalance.publishing.site.pages import Session
from folders import ROOT
from paper.html import Tree

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
    "paper/notebook/tour.ipynb": "{}\n",
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
    """The site of a copy of the project in that folder; what its commands said, next to it."""
    sessions: list[Session] = []

    def session(*folders: Path) -> Session:
        sessions.append(Session(*folders))
        return sessions[-1]

    with mock.patch.object(pages, "Session", session):
        pages.build(project(folder / "project"), folder / "site", parser())
    (folder / "said.pickle").write_bytes(pickle.dumps(sessions[0]._said))
    return folder / "site"


def with_commands_of(first: Path) -> AbstractContextManager[object]:
    """While this lasts, pages show what commands said and wrote for the site that was `built` in the folder `first`.

    The commands take most of the time. That they give the same bytes each time is tested where the commands are.
    """

    def session(folder: Path, inputs: Path) -> Session:
        shutil.copytree(first / "site/run", folder)
        replayed = Session(folder, inputs)
        replayed._said |= pickle.loads((first / "said.pickle").read_bytes())
        return replayed

    return mock.patch.object(pages, "Session", session)


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
    ids = {element[name] for element in tree.all for name in ("id", "name") if name in element}
    links, linked = (
        [element["href"] for element in tree.named(tag) if element.get("href")]
        for tag in ("a", "link")
    )
    loaded = [
        element[name] for element in tree.all for name in ("src", "srcset") if name in element
    ]
    text = "".join(element["text"] for element in tree.all if not element["within"])
    return Page(ids, links, linked + loaded, text)


def local(page: Path, target: str) -> tuple[Path, str] | None:
    """(file, place in it) that a link of a page leads to; None for one that leads to an address."""
    parts = urlsplit(target)
    if parts.scheme or parts.netloc:
        return None
    path = (page.parent / unquote(parts.path)).resolve() if parts.path else page
    return path, unquote(parts.fragment)
