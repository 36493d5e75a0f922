"""What the site adds to Sphinx: docstrings in the style of this project, formulas as MathML, names that are links."""

from __future__ import annotations

import re
from importlib import import_module
from typing import Any

from docutils import nodes
from pygments.lexers.special import TextLexer
from sphinx.addnodes import desc_signature, index
from sphinx.application import Sphinx
from sphinx.util.nodes import make_refnode
from sphinx.writers.html5 import HTML5Translator

from dampbalance.project.wording import SYMBOL
from dampbalance.publishing import formulas
from dampbalance.publishing.site.reference import markup, resolved
from dampbalance.publishing.words import rich

PACKAGE = "dampbalance"


_AS_IT_IS = (
    nodes.literal,
    nodes.literal_block,
    nodes.math,
    nodes.math_block,
    nodes.raw,
    nodes.comment,
)

_LONG_TYPE = re.compile(r"TypeAliasForwardRef\('(\w+)'\)|~(?:\w+\.)+")

_PATH = re.compile(r"[a-z][a-z_]*(?:\.[A-Za-z]\w*)+")
_SIGNATURE = re.compile(r'<dt class="sig\b.*?</dt>', re.DOTALL)
_EMPTY_HEAD = re.compile(r'<th class="head[^"]*">(?:<p></p>)?</th>')
_PART = re.compile(r"<(/?)(d[ld])>")


class Symbol(nodes.Inline, nodes.TextElement):
    """A symbol with its index, such as F_k: searched as it is typed, shown as it is printed."""


def setup(app: Sphinx) -> dict[str, Any]:
    """Add it all."""
    app.add_html_math_renderer("mathml", (_inline_formula, None), (_displayed_formula, None))
    for name in ("csv", "screen"):
        app.add_lexer(name, TextLexer)
    app.connect("autodoc-process-docstring", _docstring)
    app.connect("autodoc-process-signature", _signature)
    app.add_node(Symbol, html=(_symbol, None))
    app.connect("doctree-read", _enter_keywords)
    app.connect("doctree-resolved", _link_names)
    app.connect("doctree-resolved", _set_symbols)
    app.connect("html-page-context", _for_all_readers)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}


def _docstring(
    app: Sphinx, what: str, name: str, found: Any, options: Any, lines: list[str]
) -> None:
    lines[:] = markup(lines)


def _signature(
    app: Sphinx,
    what: str,
    name: str,
    found: Any,
    options: Any,
    arguments: str | None,
    returned: str | None,
) -> tuple[str | None, str | None]:
    """Types as short as they are written: those of numpy by their alias, others without their module."""
    return tuple(text and _LONG_TYPE.sub(r"\1", text) for text in (arguments, returned))


def _inline_formula(translator: HTML5Translator, node: nodes.math) -> None:
    translator.body.append(formulas.inline(node.astext()))
    raise nodes.SkipNode


def _displayed_formula(translator: HTML5Translator, node: nodes.math_block) -> None:
    translator.body.append(f"{formulas.displayed(node.astext())}\n")
    raise nodes.SkipNode


def _enter_keywords(app: Sphinx, tree: nodes.document) -> None:
    """The words under which a page is looked for, which its first lines state (`keywords: …`), as entries of the index:
    the search shows such a page first."""
    words = app.env.metadata[app.env.docname].get("keywords", "")
    entries = [("single", word.strip(), "", "main", None) for word in words.split(",") if word]
    tree.append(index(entries=entries))


def _link_names(app: Sphinx, tree: nodes.document, page: str) -> None:
    """A code span that names something documented leads to it: by its path in the package, a registry by its name."""
    known = app.env.domains["py"].objects
    registries = {path.rpartition(".")[2]: path for path in known if known[path].objtype == "data"}
    for literal in list(tree.findall(nodes.literal)):
        text = literal.astext().removesuffix("()")
        paths = (text, f"{PACKAGE}.{text}", _handed_on(text), registries.get(text))
        found = next((known[path] for path in paths if path in known), None)
        if found is None or _within(literal, (nodes.reference, nodes.title, nodes.term)):
            continue
        link = make_refnode(app.builder, page, found.docname, found.node_id, literal.deepcopy())
        literal.replace_self(link)


def _handed_on(name: str) -> str | None:
    """Under which name the package hands on what has that path in it, motion.orbit.Orbit.W for one; None for others."""
    if not _PATH.fullmatch(name):
        return None
    try:
        module, _, place = resolved(f"{PACKAGE}.{name}")
        first = place.split(".")[0]
        same = getattr(import_module(module), first) is getattr(import_module(PACKAGE), first)
    except (LookupError, AttributeError):
        return None
    return f"{PACKAGE}.{place}" if same else None


def _set_symbols(app: Sphinx, tree: nodes.document, page: str) -> None:
    """The symbols of running text as nodes of their own."""
    for node in list(tree.findall(nodes.Text)):
        text = node.astext()  # a Text is a str that may hold marks of its own
        found = list(SYMBOL.finditer(text))
        if not found or _within(node, (*_AS_IT_IS, desc_signature)):
            continue
        parts: list[nodes.Node] = []
        at = 0
        for symbol in found:
            parts += [nodes.Text(text[at : symbol.start()]), Symbol("", symbol[0])]
            at = symbol.end()
        node.parent.replace(node, [*parts, nodes.Text(text[at:])])


def _symbol(translator: HTML5Translator, node: Symbol) -> None:
    translator.body.append(str(rich(node.astext())))
    raise nodes.SkipNode


def _for_all_readers(
    app: Sphinx, page: str, template: str, context: dict[str, Any], tree: nodes.document | None
) -> None:
    """A page without what a screen reader stumbles over: lists without terms, which Sphinx makes of the arguments
    of a long signature, and heads of columns without words."""
    if "body" in context:
        body = _SIGNATURE.sub(lambda signature: _PART.sub(_span, signature[0]), context["body"])
        context["body"] = _EMPTY_HEAD.sub("<td></td>", body)


def _span(tag: re.Match[str]) -> str:
    return "</span>" if tag[1] else f'<span class="{tag[2]}">'


def _within(node: nodes.Node, kinds: tuple[type[nodes.Node], ...]) -> bool:
    parent = node.parent
    while parent is not None:
        if isinstance(parent, kinds):
            return True
        parent = parent.parent
    return False
