"""Builds the site from templates, texts, docstrings, schemas, commands and studies.

Sphinx runs in a temporary folder and in a separate process; any warning that it gives is an error. The same project
gives the same bytes in any folder.
"""

from __future__ import annotations

import argparse
import os
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
from . import keys, names
from .gallery import gallery
from .pages import EXTRA, Pages, SiteError

SOURCE = "paper/site"
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
        _put(made, target)


def write_pages(root: Path, stage: Path, parser: argparse.ArgumentParser) -> None:
    """Write the sources of the site for Sphinx: pages, settings, styles, and the files that pages show or link to."""
    shutil.copytree(root / SOURCE, stage, ignore=shutil.ignore_patterns("*.md", "__pycache__"))
    pages = Pages(root, SOURCE, _functions(root, parser))
    for name, text in pages.made().items():
        (stage / name).parent.mkdir(parents=True, exist_ok=True)
        (stage / name).write_text(text, encoding="utf-8")
    pages.mirror.copy(stage / EXTRA)


def _functions(root: Path, parser: argparse.ArgumentParser) -> Mapping[str, Any]:
    """The functions and values that templates may use."""
    commands = commands_of(parser)
    equations = (root / EQUATIONS).read_text(encoding="utf-8")
    return {
        "version": dampbalance.__version__,
        "commands": commands,
        "command": lambda name: _help(commands[name]),
        "schema": lambda path: keys.tables(read_yaml(root / path), _REGISTRIES),
        "gallery": lambda: gallery(root),
        "terms": KNOWN_TERMS.values(),
        "public": names.by_room(dampbalance.__all__, PACKAGE),
        "documented": names.directives,
        "others": lambda naming: names.others([equations, naming], PACKAGE),
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
