"""Text of a user shows as it is: in Markdown, in figures, on the page."""

from __future__ import annotations

import html
import re
from xml.etree import ElementTree

import pytest
from jinja2.utils import htmlsafe_json_dumps
from markdown_it import MarkdownIt
from matplotlib.figure import Figure

from dampbalance.figures.style import save
from dampbalance.project.wording import in_figure, in_markdown, markdown_table
from dampbalance.publishing.words import rich

TEXTS = [
    "<script>alert('x')</script>",
    "a | b || c",
    "costs $5, or $x$ and $\\frac{1}{2}$",
    "back\\slash \\alpha \\\\ end\\",
    "`code` and ``more``",
    "*stars* **two** _under_ __two__ snake_case F_k",
    "[a link](http:x) ![image](y) [^1] <b>",
    "# heading",
    "1. one",
    "- item",
    "+ item",
    "===",
    "~~gone~~ H~2~O",
    "&lt; &amp; &#x41;",
    "</script><!-- comment -->",
    "plain ω/ω_n = 2.25, 10 %, a–b",
]


def in_html(text):
    return MarkdownIt("commonmark").enable(["table", "strikethrough"]).render(text)


@pytest.mark.parametrize("text", TEXTS)
def test_markdown_shows_the_text(text):
    page = in_html(in_markdown(text))
    assert re.fullmatch(r"<p>[^<>]*</p>\s*", page), page  # a paragraph, and no other element
    assert html.unescape(page.strip()[3:-4]) == text.strip()


@pytest.mark.parametrize("text", TEXTS)
def test_a_cell_of_a_markdown_table_shows_the_text(text):
    page = in_html(f"| a | b |\n|---|---|\n| {in_markdown(text)} | end |\n")
    cells = re.findall(r"<td>(.*?)</td>", page)
    assert [html.unescape(cell) for cell in cells] == [text.strip(), "end"]


@pytest.mark.parametrize("text", TEXTS)
def test_a_figure_shows_the_text(tmp_path, text):
    figure = Figure(figsize=(8, 1))
    label = figure.text(0.0, 0.5, in_figure(text))
    assert label._preprocess_math(label.get_text()) == (text, False)
    save(figure, tmp_path / "a.svg", tmp_path / "a.png", text)
    described = ElementTree.parse(tmp_path / "a.svg").getroot().itertext()
    assert text in "".join(described)


@pytest.mark.parametrize("text", TEXTS)
def test_the_page_shows_the_text(text):
    shown = re.sub(r"</?i>|</sub>", "", str(rich(text)).replace("<sub>", "_"))  # X_s has its index
    assert html.unescape(shown).replace("\xa0", " ") == text
    script = str(htmlsafe_json_dumps({"text": text}))
    assert "</" not in script
    assert "<!--" not in script


def test_a_table_in_markdown():
    rows = [["a", "b", "1"], ["", "c", "2"]]
    assert markdown_table(["", "name", "n"], rows, "llr").splitlines() == [
        "| | name | n |",
        "|---|---|---:|",
        "| a | b | 1 |",
        "|  | c | 2 |",
    ]
    assert markdown_table(["x", "y"], []) == "| x | y |\n|---|---|"
