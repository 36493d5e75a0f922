"""Compile the article with typst: a warning is an error, and the same inputs give the same bytes."""

from __future__ import annotations

import json
import shutil
import tempfile
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Literal, TypeVar

import typst
from matplotlib import get_data_path

STANDARDS: list[Literal["a-3a", "ua-1"]] = ["a-3a", "ua-1"]
"""PDF/A-3 at level a (which includes level b), for archiving; PDF/UA, so that it can be read aloud: a figure or an
equation without alternative text is an error."""

# 1 January 2026, always: the bytes do not depend on the day of the build.
TIMESTAMP = 1_767_225_600

Inputs = Mapping[str, object]
Source = TypeVar("Source", Path, bytes)
"""A typst file, or its text."""


class ArticleError(RuntimeError):
    """The article does not compile, or compiles with a warning."""


def compiler(source: Source, root: str | Path, inputs: Inputs) -> typst.Compiler:
    """Return a compiler that knows the fonts of typst and matplotlib alone: the article looks the same everywhere.

    The fonts of matplotlib set the article in the face of its figures (`figures.style`).

    inputs : values that the article reads as JSON in `sys.inputs.given`. It is one input, as typst takes several in an
    order that changes from call to call, and lays a document out again when it differs.
    """
    given = {"given": json.dumps(inputs)}
    fonts = typst.Fonts(include_system_fonts=False, font_paths=[Path(get_data_path(), "fonts/ttf")])
    return typst.Compiler(source, root=str(root), font_paths=fonts, sys_inputs=given)


def query(source: Source, root: str | Path, inputs: Inputs, selector: str, field: str) -> list[Any]:
    """Compile a source and return a field of every element that a selector matches, in the order of the document."""
    return json.loads(compiler(source, root, inputs).query(selector, field=field, format="json"))


def version() -> str:
    """Return the version of typst, which a PDF names as its creator; its package for Python may have another."""
    source = b'#metadata(array(sys.version).map(str).join("."))<version>'
    return str(query(source, ".", {}, "<version>", "value")[0])


def article(folder: str | Path, results: str | Path, inputs: Inputs) -> bytes:
    """Return the PDF of the article in a folder, with results that are kept anywhere."""
    with article_next_to_results(folder, results) as source:
        return pdf(source, source.parents[1], inputs)


@contextmanager
def article_next_to_results(folder: str | Path, results: str | Path) -> Iterator[Path]:
    """Yield the source of the article in a folder, as typst can read it with results that are kept anywhere.

    typst reads files below one folder only, and names the files that it attaches by their paths from there. So the
    article stands in a temporary folder in which /article is a copy of `folder` and /results leads to `results`.
    """
    with tempfile.TemporaryDirectory(prefix="article-") as top:
        source = shutil.copytree(folder, Path(top, "article"))
        Path(top, "results").symlink_to(Path(results).resolve())
        yield source / "article.typ"


def pdf(source: Path, root: str | Path, inputs: Inputs) -> bytes:
    """Return the article as PDF/A and PDF/UA. Raises ArticleError for an error of typst, and for a warning."""
    try:
        document, warnings = compiler(source, root, inputs).compile_with_warnings(
            format="pdf", pdf_standards=[*STANDARDS], timestamp=TIMESTAMP
        )
    except typst.TypstError as error:
        raise ArticleError(_message([error], "does not compile")) from None
    if warnings:
        raise ArticleError(_message(warnings, "compiles with warnings, which count as errors"))
    assert isinstance(document, bytes)
    return document


def _message(problems: Iterable[object], what: str) -> str:
    lines = [f"the article {what}:"]
    for problem in problems:
        lines.append(f"  {getattr(problem, 'message', problem)}")
        lines += [f"    hint: {hint}" for hint in getattr(problem, "hints", None) or []]
        lines += [f"    {line}" for line in getattr(problem, "trace", None) or []]
    return "\n".join(lines)
