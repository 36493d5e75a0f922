"""typst, with warnings as errors, and the same bytes each time."""

from __future__ import annotations

import json
import shutil
import tempfile
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Literal

import typst

STANDARDS: list[Literal["a-3a", "ua-1"]] = ["a-3a", "ua-1"]
"""PDF/A-3 at level a, which holds all that level b asks for, for keeping; PDF/UA, so that it can be read aloud: a
figure or an equation without alternative text is an error."""

# 1 January 2026, a constant: the bytes do not change with the day of the build
TIMESTAMP = 1_767_225_600


class ArticleError(RuntimeError):
    """The article does not compile, or compiles with a warning."""


def compiler(source: str | Path, root: str | Path, inputs: Mapping[str, str]) -> typst.Compiler:
    """A compiler that knows no fonts but typst's own: the article looks the same on every machine."""
    return typst.Compiler(
        str(source), root=str(root), ignore_system_fonts=True, sys_inputs=dict(inputs)
    )


def version() -> str:
    """The version of typst itself, as a PDF names its creator; that of the Python package may differ."""
    told = typst.Compiler(b'#metadata(array(sys.version).map(str).join("."))<version>')
    return str(json.loads(told.query("<version>", field="value", one=True, format="json")))


def article(folder: str | Path, results: str | Path, inputs: Mapping[str, str]) -> bytes:
    """The article of this folder with these results.

    typst reads below one folder, and names the files that it attaches by their paths from there: a passing folder, in
    which the results are /results wherever they are kept.
    """
    with tempfile.TemporaryDirectory(prefix="article-") as top:
        source = shutil.copytree(folder, Path(top, "article"))
        Path(top, "results").symlink_to(Path(results).resolve())
        return pdf(source / "article.typ", top, inputs)


def pdf(source: str | Path, root: str | Path, inputs: Mapping[str, str]) -> bytes:
    """The article as PDF/A and PDF/UA. Raises ArticleError for an error of typst, and for a warning."""
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
