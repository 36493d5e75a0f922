"""Builds the site from templates, texts, docstrings, schemas, commands and studies.

Sphinx runs in a temporary folder and in a separate process; any warning that it gives is an error. The same project
gives the same bytes in any folder.
"""

from __future__ import annotations

import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile
import textwrap
from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import Any

import dampbalance

from ...balance import APPROACHES
from ...law.terms import KNOWN_TERMS
from ...project.documents import read_yaml
from ...project.files import UNFINISHED
from ...project.wording import in_markdown
from ..formulas import font_face
from . import keys, reference
from .pages import EXTRA, Pages, SiteError
from .session import Session, shown

STUDIES, RESULTS = "config/studies", "results/studies"

_FIGURE_OR_TABLE = re.compile(r"^(?:!\[|\||Size of the relative error)", re.MULTILINE)
_VARIED = re.compile(r"(?<= cases; varied: )[\w, ]+")


def gallery(root: str | Path) -> str:
    """Markdown sections for all studies of a project, in the order of their files."""
    root = Path(root)
    return "\n".join(_entry(root, file) for file in sorted((root / STUDIES).glob("*.yaml")))


def _entry(root: Path, file: Path) -> str:
    settings = read_yaml(file)
    title = in_markdown(" ".join(str(settings["title"]).split()))
    source = f"[`{file.name}`](project:{STUDIES}/{file.name})"
    folder = f"{RESULTS}/{file.stem}"
    lines = [f"## {title}", ""]
    summary = root / folder / "summary.md"
    if summary.is_file():
        lines += [_shown(summary.read_text(encoding="utf-8")), ""]
        if (root / folder / "figure.svg").is_file():
            lines += [f"![{title}](project:{folder}/figure.svg)", ""]
        lines += [f"{source}, [the table of errors](project:{folder}/summary.csv)", ""]
    else:
        lines += [f"{source}. Not computed yet: `snakemake --cores all {folder}/summary.md`", ""]
    return "\n".join(lines)


def _shown(summary: str) -> str:
    """The paragraphs of a summary between its title and its figure or table, with the names of axes as code."""
    body = summary.split("\n", 1)[1]
    before = _FIGURE_OR_TABLE.split(body, maxsplit=1)[0].strip()
    return _VARIED.sub(lambda line: re.sub(r"\w+", r"`\g<0>`", line[0]), before)


SOURCE = "paper/site"
CASE = "case"  # folder of the worked case
RUN = "run"  # folder of the site with what its commands write
EQUATIONS = "paper/equations.md"
PACKAGE = "dampbalance"
_WIDTH = 64  # letters of a command's help in a line: what a page shows without scrolling
_REGISTRIES = {"approach": list(APPROACHES), "term": list(KNOWN_TERMS)}


def build(root: str | Path, target: str | Path, parser: argparse.ArgumentParser) -> None:
    """Build the site of the project in the folder `root` into the folder `target`, which is replaced.

    parser : the parser of the command line, with its commands.

    Raises SiteError for a page that cannot be rendered, and for any warning of Sphinx.
    """
    root, target = Path(root), Path(target)
    with tempfile.TemporaryDirectory(prefix="site-") as folder:
        stage, made = Path(folder, "pages"), Path(folder, "made")
        write_pages(root, stage, parser)
        _run_sphinx(stage, made, Path(folder, "trees"))
        (made / ".buildinfo").unlink()  # serves only another run of Sphinx in this folder
        (made / "_sources").rmdir()
        pages = (page.read_text(encoding="utf-8") for page in sorted(made.rglob("*.html")))
        with (made / "_static/site.css").open("a", encoding="utf-8") as style:
            style.write(font_face("".join(pages)))
        _put(made, target)


def write_pages(root: Path, stage: Path, parser: argparse.ArgumentParser) -> None:
    """Write the sources of the site for Sphinx: pages, settings, styles, and the files that pages show or link to."""
    ignored = shutil.ignore_patterns("*.md", "__pycache__", CASE)
    shutil.copytree(root / SOURCE, stage, ignore=ignored)
    session = Session(stage / EXTRA / RUN, Path(dampbalance.__file__).parents[1], root / SOURCE)
    pages = Pages(root, SOURCE, _functions(root, parser, session))
    for name, text in pages.made().items():
        (stage / name).parent.mkdir(parents=True, exist_ok=True)
        (stage / name).write_text(text, encoding="utf-8")
    pages.write_copies(stage / EXTRA)


def _functions(root: Path, parser: argparse.ArgumentParser, session: Session) -> Mapping[str, Any]:
    """The functions and values that templates may use."""
    commands = commands_of(parser)
    equations = (root / EQUATIONS).read_text(encoding="utf-8")
    return {
        "version": dampbalance.__version__,
        "commands": commands,
        "command": lambda name: _help(commands[name]),
        "schema": lambda path: keys.tables(read_yaml(root / path), _REGISTRIES),
        "gallery": lambda: gallery(root),
        "run": session.run,
        "document": session.document,
        "screen": shown,
        "source": lambda path: (root / path).read_text(encoding="utf-8").strip(),
        "terms": KNOWN_TERMS.values(),
        "public": reference.by_room(dampbalance.__all__, PACKAGE),
        "documented": reference.directives,
        "others": lambda naming: reference.others([equations, naming], PACKAGE),
    }


def _help(command: argparse.ArgumentParser) -> str:
    """The help of a command as it shows it, in lines that a page has room for."""
    command.formatter_class = partial(argparse.RawDescriptionHelpFormatter, width=_WIDTH)
    parts = command.format_help().rstrip().split("\n\n")
    prose = [not any(line.startswith(" ") for line in part.splitlines()) for part in parts]
    filled = [
        textwrap.fill(p, _WIDTH) if plain else p for p, plain in zip(parts, prose, strict=True)
    ]
    return "```\n" + "\n\n".join(filled) + "\n```\n"


def commands_of(parser: argparse.ArgumentParser) -> dict[str, argparse.ArgumentParser]:
    """The commands of a command line, by name."""
    (commands,) = (a for a in parser._actions if isinstance(a, argparse._SubParsersAction))
    return dict(commands.choices)


def _run_sphinx(stage: Path, made: Path, trees: Path) -> None:
    source = str(Path(dampbalance.__file__).parents[1])
    environment = os.environ | {
        "PYTHONPATH": os.pathsep.join(filter(None, [source, os.environ.get("PYTHONPATH")])),
        "PYTHONHASHSEED": "0",
        "SOURCE_DATE_EPOCH": "0",
    }
    flags = ["-b", "html", "-W", "--keep-going", "-n", "-q", "-j", "1", "-d", str(trees)]
    command = [sys.executable, "-m", "sphinx", *flags, str(stage), str(made)]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    if done.returncode:
        said = (done.stderr or done.stdout).replace(f"{stage}/", f"{SOURCE}/")
        raise SiteError(f"the site was not built:\n{said}")


def _put(made: Path, target: Path) -> None:
    """Replace a folder by another; the old one is removed only when the new one is complete."""
    target.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=target.parent, prefix=f"{UNFINISHED}site-") as folder:
        ready = shutil.copytree(made, Path(folder, "ready"))
        if target.exists():
            target.rename(Path(folder, "before"))
        ready.rename(target)
