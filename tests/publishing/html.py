"""A page as its elements: for tests that ask what it holds, where it leads, and whether its tags are closed."""

from __future__ import annotations

import re
from html import unescape
from html.parser import HTMLParser

VOID = {"meta", "link", "input", "br", "col", "hr", "img", "source"}
ADDRESSES = ("src", "href", "srcset", "data", "poster", "action")


def in_a_line(text):
    """Text in one line, as its lines are broken where a screen ends."""
    return " ".join(text.split())


def words(html):
    """Text of a page, a blank between cells."""
    return in_a_line(unescape(re.sub(r"<[^>]*>", "", re.sub("</t[hd]>", " ", html))))


class Tree(HTMLParser):
    """Elements with their attributes, parents and text; a tag that is not closed where it must be is an error."""

    def __init__(self, html: str) -> None:
        super().__init__(convert_charrefs=True)
        self.open: list[dict] = []
        self.all: list[dict] = []
        self.feed(html)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag, attrs):
        names = [name for name, _ in attrs]
        assert len(names) == len(set(names)), (tag, attrs)
        within = tuple(element["tag"] for element in self.open)
        element = {"tag": tag, "text": "", "within": within, **dict(attrs)}
        self.all.append(element)
        if tag not in VOID:
            self.open.append(element)

    def handle_startendtag(self, tag, attrs):
        self.handle_starttag(tag, attrs)
        if tag not in VOID:
            self.open.pop()

    def handle_endtag(self, tag):
        assert self.open, tag
        assert self.open[-1]["tag"] == tag, f"</{tag}> closes <{self.open[-1]['tag']}>"
        self.open.pop()

    def handle_data(self, data):
        code = [e for e in self.open if e["tag"] in ("script", "style")]
        for element in code or self.open:  # code is no text of what it stands in
            element["text"] += data

    def named(self, *tags):
        return [element for element in self.all if element["tag"] in tags]

    def one(self, tag, **attributes):
        """The first element of a tag with these attributes; `class_` stands for class."""
        wanted = {key.rstrip("_"): value for key, value in attributes.items()}
        return next(e for e in self.named(tag) if wanted.items() <= e.items())

    @property
    def ids(self):
        return [element["id"] for element in self.all if "id" in element]

    @property
    def addresses(self):
        """Everything that the page would load or that it points at."""
        return [element[name] for element in self.all for name in ADDRESSES if element.get(name)]
