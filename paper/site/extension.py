"""Additions to Sphinx: links of included texts, keys of schemas, docstrings, formulas as MathML, links of names."""

from __future__ import annotations

import posixpath
import re
import textwrap
from collections.abc import Iterator, Mapping
from functools import reduce
from itertools import groupby
from operator import getitem, itemgetter
from pathlib import Path
from typing import Any

from docstrings import markup
from docutils import nodes
from docutils.utils.math.latex2mathml import tex2mathml
from myst_parser.mdit_to_docutils.base import default_slugify
from pygments.lexers.special import TextLexer
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective
from sphinx.util.nodes import make_refnode
from sphinx.writers.html5 import HTML5Translator
from sphinxcontrib.programoutput import run_programs

import dampbalance
from dampbalance.balance import APPROACHES
from dampbalance.law.terms import KNOWN_TERMS
from dampbalance.project.case import SCHEMA, read_case_schema
from dampbalance.project.documents import read_schema
from dampbalance.project.wording import in_markdown, markdown_table
from dampbalance.publishing.site import PAGES

WIDTH = 120  # letters of a line of output that is not a row of a table: what commands write their help in
REPORT = "results/paper/report.html"  # its copy is shown by a browser, and not saved


def setup(app: Sphinx) -> dict[str, Any]:
    """Add it all."""
    app.add_html_math_renderer("mathml", (_inline_formula, None), (_displayed_formula, None))
    for name in ("csv", "screen"):
        app.add_lexer(name, TextLexer)
    app.add_directive("keys", Keys)
    app.connect("include-read", _lead_links)
    # before Sphinx looks for pictures, which the programs write
    app.connect("doctree-read", _run_programs, priority=100)
    app.connect("autodoc-process-docstring", _docstring)
    app.connect("autodoc-process-signature", _signature)
    app.connect("doctree-resolved", _link_names)
    app.connect("html-page-context", _for_all_readers)
    return {"version": "1", "parallel_read_safe": False}


# --- texts of the project, which pages include ---------------------------------------------------

_INCLUDE = re.compile(r"^```\{include\} (\S+)\n((?::.*\n)*)", re.MULTILINE)
_OPTION = re.compile(r'^:(.*): "(.*)"$', re.MULTILINE)
_LINK = re.compile(r"(?P<code>(`+)(?!`).+?(?<!`)\2(?!`))|(?<=\]\()(?P<target>[^()\s]+)(?=\))", re.S)


def parts_of(pages: Path) -> dict[tuple[Path, str], str]:
    """The place of each section of the included texts: (text, anchor of a heading) → page, with its anchor there.

    The anchor "" stands for the text itself, which is where its beginning is. A section that is included without its
    heading is at the top of its page, or at the heading of its name there.
    """
    parts = {}
    for page in sorted(pages.rglob("*.md")):
        address, text = f"/{page.relative_to(pages).as_posix()}", page.read_text(encoding="utf-8")
        own = re.findall("^#+ (.+)$", text, re.MULTILINE)
        for path, options in _INCLUDE.findall(text):
            file, cut = (page.parent / path).resolve(), dict(_OPTION.findall(options))
            first, last = cut.get("start-after", ""), cut.get("end-before")
            shown = file.read_text(encoding="utf-8")
            shown = first + shown.partition(first)[2] if first else shown
            shown = shown.partition(last)[0] if last else shown
            for heading in re.findall("^#+ (.+)$", shown, re.MULTILINE):
                here = heading != first.lstrip("# ") or heading in own[1:]
                parts[file, default_slugify(heading)] = (
                    address + f"#{default_slugify(heading)}" * here
                )
            if not first.startswith("##"):
                parts[file, ""] = address
    return parts


def _lead_links(app: Sphinx, path: Path, page: str, content: list[str]) -> None:
    """Lead the links of an included text to the page that shows their target, or to the file itself."""
    parts = parts_of(Path(app.srcdir))
    folder = (Path(app.srcdir) / path).resolve().parent
    root = Path(app.srcdir).parents[1]

    def led(link: re.Match[str]) -> str:
        target, _, place = (link["target"] or "").partition("#")
        if not target or re.match("[a-z]+:", target):
            return link[0]
        file = (folder / target).resolve()
        for one in (file, file / "README.md"):
            for anchor in (place, ""):
                if (one, anchor) in parts:
                    return parts[one, anchor]
        if file.is_relative_to(root / PAGES):
            file = file.with_suffix(".ipynb") if file.suffix == ".py" else file
            return f"/{file.relative_to(root / PAGES).as_posix()}" + f"#{place}" * bool(place)
        if file == root / REPORT:
            return f"copied:{'../' * app.env.docname.count('/')}files/{file.name}"
        file_itself = "path:" * (file.suffix == ".md")  # though Sphinx could make a page of it
        return f"{file_itself}/{posixpath.relpath(file, app.srcdir)}"

    content[0] = _LINK.sub(led, content[0])


# --- what programs print, and keys of schemas ----------------------------------------------------


def _run_programs(app: Sphinx, tree: nodes.document) -> None:
    """Show what programs print, its long lines wrapped, except rows of tables."""
    run_programs(app, tree)
    for block in tree.findall(nodes.literal_block):
        if block.get("language") == "screen":
            lines = (
                [line] if re.search(r"\S {3,}\S", line) else textwrap.wrap(line, WIDTH) or [""]
                for line in block.astext().split("\n")
            )
            text = "\n".join(part for parts in lines for part in parts)
            block.replace_self(nodes.literal_block(text, text, language="screen"))


class Keys(SphinxDirective):
    """A table of all keys of a schema: path, type, meaning."""

    required_arguments = 1

    def run(self) -> list[nodes.Node]:
        """Read the schema and set its table."""
        _, path = self.env.relfn2path(self.arguments[0])
        self.env.note_dependency(path)
        case = Path(path).name == SCHEMA.name  # which may be a copy
        schema = read_case_schema() if case else read_schema(path)
        table = markdown_table(["key", "type", "meaning"], list(keys_of(schema, schema)))
        return self.parse_text_to_nodes(table)


_NAMES = {"approach": APPROACHES, "term": KNOWN_TERMS}


def keys_of(node: Any, schema: Mapping[str, Any], path: str = "") -> Iterator[tuple[str, str, str]]:
    """The cells of each key of a schema; a key precedes the keys inside it.

    In a path [] stands for each entry of a list and * for a name chosen by the user. Keys that follow each other and
    are described alike share a row, with the path before the first of them.
    """
    node = _resolved(node, schema)
    for inner, mark in (("items", "[]"), ("additionalProperties", ".*")):
        if isinstance(node.get(inner), Mapping):
            yield from keys_of(node[inner], schema, path + mark)
    for child, alike in groupby(node.get("properties", {}).items(), key=itemgetter(1)):
        names = [name for name, _ in alike]
        below = f"{path}.".lstrip(".")
        needed = " *needed*" * (names[0] in node.get("required", ()))
        of_child = _resolved(child, schema)
        words = in_markdown(" ".join(of_child.get("description", "").split()))
        shown = ", ".join(f"`{name}`" for name in [below + names[0], *names[1:]])
        yield shown + needed, _type(of_child, schema), words
        yield from keys_of(child, schema, below + (names[0] if len(names) == 1 else "*"))


def _resolved(node: Mapping[str, Any], schema: Mapping[str, Any]) -> dict[str, Any]:
    """A node of a schema with what its reference (`$ref`) within the schema refers to."""
    path = node["$ref"].removeprefix("#/").split("/") if "$ref" in node else []
    return {**_resolved(reduce(getitem, path, schema), schema), **node} if path else dict(node)


def _type(node: Mapping[str, Any], schema: Mapping[str, Any]) -> str:
    """The type, or the admissible values."""
    if "anyOf" in node:
        return " or ".join(_type(_resolved(choice, schema), schema) for choice in node["anyOf"])
    values = [
        *_NAMES.get(node.get("registered", ""), ()),
        *node.get("also", ()),
        *node.get("enum", ()),
    ]
    if values or "const" in node:
        return ", ".join(
            f"`{value}`" if str(value).strip() else "a blank" for value in values or [node["const"]]
        )
    kinds = node.get("type", "any value")
    return kinds if isinstance(kinds, str) else " or ".join(kinds)


# --- docstrings and signatures -------------------------------------------------------------------

_LONG_TYPE = re.compile(r"TypeAliasForwardRef\('(\w+)'\)|~(?:\w+\.)+")


def _docstring(
    app: Sphinx, what: str, name: str, item: Any, options: Any, lines: list[str]
) -> None:
    lines[:] = markup(lines)


def _signature(
    app: Sphinx,
    what: str,
    name: str,
    item: Any,
    options: Any,
    arguments: str | None,
    returned: str | None,
) -> tuple[str | None, str | None]:
    """Types as short as they are written: those of numpy by their alias, others without their module."""
    return tuple(text and _LONG_TYPE.sub(r"\1", text) for text in (arguments, returned))


# --- formulas --------------------------------------------------------------------


def _mathml(latex: str, block: bool) -> str:
    return "".join(map(str.strip, tex2mathml(latex, as_block=block).splitlines()))


def _inline_formula(translator: HTML5Translator, node: nodes.math) -> None:
    translator.body.append(_mathml(node.astext(), block=False))
    raise nodes.SkipNode


def _displayed_formula(translator: HTML5Translator, node: nodes.math_block) -> None:
    """On a narrow screen the parts of a formula, at \\qquad, stand below each other; what is still too wide scrolls in
    its own box, which the keyboard reaches."""
    parts = (_mathml(part, block=True) for part in node.astext().split(r"\qquad"))
    label = 'role="group" tabindex="0" aria-label="Equation"'
    translator.body.append(f'<div class="equation" {label}>{"".join(parts)}</div>\n')
    raise nodes.SkipNode


# --- names ---------------------------------------------------------------------------------------


_PUBLIC = {
    f"{getattr(dampbalance, name).__module__}.{name}": f"dampbalance.{name}"
    for name in dampbalance.__all__
}
"""Path of a name in the package → its public one."""


def _link_names(app: Sphinx, tree: nodes.document, page: str) -> None:
    """A code span that names something documented leads to it, by its path in the package."""
    documented = app.env.domains["py"].objects
    for literal in list(tree.findall(nodes.literal)):
        text = literal.astext().removesuffix("()")
        path = f"dampbalance.{text.removeprefix('dampbalance.')}"
        paths = [
            path,
            *(new + path[len(old) :] for old, new in _PUBLIC.items() if path.startswith(old)),
        ]
        item = next((documented[one] for one in paths if one in documented), None)
        if item and not _within(literal, (nodes.reference, nodes.title, nodes.term)):
            link = make_refnode(app.builder, page, item.docname, item.node_id, literal.deepcopy())
            literal.replace_self(link)


def _within(node: nodes.Node, kinds: tuple[type[nodes.Node], ...]) -> bool:
    parent = node.parent
    while parent is not None and not isinstance(parent, kinds):
        parent = parent.parent
    return parent is not None


# --- readers who do not see the page -------------------------------------------------------------

_SIGNATURE = re.compile(r'<dt class="sig\b.*?</dt>', re.DOTALL)
_PART = re.compile(r"<(/?)(d[ld])>")
_EMPTY_HEAD = re.compile(r'<th(?: class="head[^"]*")?>(?:<p></p>)?</th>')


def _for_all_readers(
    app: Sphinx, page: str, template: str, context: dict[str, Any], tree: nodes.document | None
) -> None:
    """A page without what a screen reader stumbles over: lists without terms, which Sphinx makes of the arguments
    of a long signature, and heads of columns without words."""

    def span(tag: re.Match[str]) -> str:
        return "</span>" if tag[1] else f'<span class="{tag[2]}">'

    if "body" in context:
        body = _SIGNATURE.sub(lambda signature: _PART.sub(span, signature[0]), context["body"])
        context["body"] = _EMPTY_HEAD.sub("<td></td>", body)
