"""Builds the site from templates, texts, docstrings, schemas, commands and studies.

A page is a Jinja template in Markdown: `{{ text("config/README.md") }}` inserts a whole text of the project,
`{{ section("README.md", "Rebuild it") }}` one of its sections without the heading, `{{ run("case", "head run1.csv") }}`
what a command says. The links of an inserted text are rewritten to the page that shows their target, or to a copy of
the file. Sphinx runs in a temporary folder and in a separate process; any warning that it gives is an error. The same
project gives the same bytes in any folder.
"""

from __future__ import annotations

import argparse
import io
import json
import os
import posixpath
import re
import shutil
import subprocess
import sys
import tempfile
import textwrap
from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from functools import partial
from itertools import dropwhile, groupby, takewhile
from pathlib import Path
from threading import Lock
from typing import Any

import jinja2
from markdown_it import MarkdownIt

import dampbalance

from ...balance import APPROACHES, checks
from ...law.terms import KNOWN_TERMS
from ...project.documents import read_yaml
from ...project.files import UNFINISHED
from ...project.wording import in_markdown
from ..formulas import font_face
from ..notebook import as_markdown
from ..words import templates
from . import reference

SCHEME = "project:"
"""Prefix of a link to a file of the project, followed by the path from the root."""

FILE = "copied:"
"""Prefix of a link to a copied file; Sphinx does not change the rest of such a link."""

EXTRA, FOLDER, RUN = "extra", "files", "run"
"""The folder next to the pages that Sphinx copies unchanged; in it, copied files and what commands write."""

SOURCE, CASE = "paper/site", "case"  # the templates; in them, the folder of the worked case
EQUATIONS = "paper/equations.md"
PACKAGE_FOLDER = Path(__file__).parents[3]
WIDTH = 112  # letters of a line of output that is not a row of a table
_HELP_WIDTH = 64  # letters of a command's help in a line: what a page shows without scrolling
_REGISTRIES = {
    "approach": list(APPROACHES),
    "check": [*map(str, checks())],
    "term": list(KNOWN_TERMS),
}
_AT_ONCE = 2  # pages that are rendered
_LARGEST = 4_000_000  # bytes of a file that is copied
_ONE = 0x2460  # ①
_PROGRAMS = {"python": '"$PYTHON"', "dampbalance": '"$PYTHON" -m dampbalance'}

_HEADING = re.compile(r"(#{1,6})\s+(.+?)\s*$")
_COMMENT = re.compile(r"^<!--.*?-->\n?", re.MULTILINE | re.DOTALL)
_LINK = re.compile(
    r"(`+)(?:(?!\1).)+?\1|(?P<before>(?P<picture>!?)\[[^\[\]]*\]\()(?P<target>[^()\s]+)\)",
    re.DOTALL,
)
_PATH = re.compile(r"\[`[^`]*[/.][^`]*`\]\(")  # a link under the name of a file or folder
_PAGE = re.compile(r"[^:]*\.md(?:#.*)?")
_LOCAL_LINK = re.compile(r"""(?<=<a)([^>]*?)\shref="(?![a-z]+:|#)([^"#]*)(?:#[^"]*)?"(?=[^>]*>)""")
_FIGURE_OR_TABLE = re.compile(r"^(?:!\[|\||Size of the relative error)", re.MULTILINE)
_VARIED = re.compile(r"(?<= cases; varied: )[\w, ]+")


class SiteError(ValueError):
    """A page cannot be rendered; the message names the page and the problem."""


def build(root: str | Path, target: str | Path, parser: argparse.ArgumentParser) -> None:
    """Build the site of the project in the folder `root` into the folder `target`, which is replaced.

    parser : the parser of the command line, with its commands.

    Raises SiteError for a page that cannot be rendered, and for any warning of Sphinx.
    """
    root, target = Path(root), Path(target)
    with tempfile.TemporaryDirectory(prefix="site-") as folder:
        stage, made = Path(folder, "pages"), Path(folder, "made")
        write_pages(root, stage, parser)
        flags = ["-b", "html", "-W", "--keep-going", "-n", "-q", "-j", "1", "-d", f"{folder}/trees"]
        done = subprocess.run(
            [sys.executable, "-m", "sphinx", *flags, str(stage), str(made)],
            env=_environment(PYTHONHASHSEED="0", SOURCE_DATE_EPOCH="0"),
            capture_output=True,
            text=True,
            check=False,
        )
        if done.returncode:
            said = (done.stderr or done.stdout).replace(f"{stage}/", f"{SOURCE}/")
            raise SiteError(f"the site was not built:\n{said}")
        (made / ".buildinfo").unlink()  # serves only another run of Sphinx in this folder
        (made / "_sources").rmdir()
        pages = (page.read_text(encoding="utf-8") for page in sorted(made.rglob("*.html")))
        with (made / "_static/site.css").open("a", encoding="utf-8") as style:
            style.write(font_face("".join(pages)))
        target.parent.mkdir(parents=True, exist_ok=True)
        # the old site is removed only when the new one is complete
        with tempfile.TemporaryDirectory(dir=target.parent, prefix=f"{UNFINISHED}site-") as aside:
            ready = shutil.copytree(made, Path(aside, "ready"))
            if target.exists():
                target.rename(Path(aside, "before"))
            ready.rename(target)


def write_pages(root: Path, stage: Path, parser: argparse.ArgumentParser) -> None:
    """Write the sources of the site for Sphinx: pages, settings, styles, and the files that pages show or link to."""
    ignored = shutil.ignore_patterns("*.md", "__pycache__", CASE)
    shutil.copytree(root / SOURCE, stage, ignore=ignored)
    session = Session(stage / EXTRA / RUN, root / SOURCE)
    commands = commands_of(parser)
    equations = (root / EQUATIONS).read_text(encoding="utf-8")
    functions = {
        "version": dampbalance.__version__,
        "commands": commands,
        "command": lambda name: _help(commands[name]),
        "schema": lambda path: reference.tables(read_yaml(root / path), _REGISTRIES),
        "studies": lambda: _studies(root),
        "run": session.run,
        "document": lambda path: json.loads((session.folder / path).read_text(encoding="utf-8")),
        "screen": screen,
        "notebook": lambda path: as_markdown(root / path),
        "source": lambda path: (root / path).read_text(encoding="utf-8").strip(),
        "terms": KNOWN_TERMS.values(),
        "public": reference.by_room(dampbalance.__all__, "dampbalance"),
        "documented": reference.directives,
        "others": lambda naming: reference.others([equations, naming], "dampbalance"),
    }
    for name, text in Pages(root, SOURCE, functions, stage / EXTRA).made().items():
        (stage / name).parent.mkdir(parents=True, exist_ok=True)
        (stage / name).write_text(text, encoding="utf-8")


def commands_of(parser: argparse.ArgumentParser) -> dict[str, argparse.ArgumentParser]:
    """The commands of a command line, by name."""
    (commands,) = (a for a in parser._actions if isinstance(a, argparse._SubParsersAction))
    return dict(commands.choices)


def _help(command: argparse.ArgumentParser) -> str:
    """The help of a command as it shows it, in lines that a page has room for."""
    command.formatter_class = partial(argparse.RawDescriptionHelpFormatter, width=_HELP_WIDTH)
    parts = command.format_help().rstrip().split("\n\n")
    filled = (p if re.search("^ ", p, re.M) else textwrap.fill(p, _HELP_WIDTH) for p in parts)
    return "```\n" + "\n\n".join(filled) + "\n```\n"


def _studies(root: Path) -> Iterator[dict[str, str]]:
    """The studies of a project in the order of their files: title, file, folder of results, and in words what came out.

    words : the paragraphs of the summary before its figure or table, with the names of axes as code; "" without one.
    """
    for file in sorted((root / "config/studies").glob("*.yaml")):
        folder = f"results/studies/{file.stem}"
        summary = root / folder / "summary.md"
        said = summary.read_text(encoding="utf-8").split("\n", 1)[1] if summary.is_file() else ""
        words = _FIGURE_OR_TABLE.split(said, maxsplit=1)[0].strip()
        yield {
            "title": in_markdown(" ".join(str(read_yaml(file)["title"]).split())),
            "file": file.name,
            "folder": folder,
            "words": _VARIED.sub(lambda line: re.sub(r"\w+", r"`\g<0>`", line[0]), words),
        }


def _environment(**settings: str) -> dict[str, str]:
    """The environment of a process that imports this package, with further variables."""
    paths = filter(None, [str(PACKAGE_FOLDER), os.environ.get("PYTHONPATH")])
    return {**os.environ, "PYTHONPATH": os.pathsep.join(paths), **settings}


class Session:
    """Shells below a folder, each in its place: a page shows what commands say and write, not what once was typed.

    folder : for the files, which the site holds.   inputs : folder of files to start from; its programs write the
    others. A command that a second page shows is not run again.
    """

    def __init__(self, folder: Path, inputs: Path) -> None:
        self.folder, self.inputs = folder, inputs
        self._said: dict[tuple[str, str], str] = {}
        self._busy: defaultdict[str, Lock] = defaultdict(Lock)

    def run(self, place: str, command: str, status: int = 0) -> str:
        """What a command says in the folder `place`; its line stands in commands.sh there.

        status : which it ends with.   Raises SiteError where it ends with another.
        """
        with self._busy[place]:
            if (place, command) not in self._said:
                folder, inputs = self.folder / place, self.inputs / place
                if not folder.exists():
                    folder.mkdir(parents=True)
                    if inputs.is_dir():
                        shutil.copytree(inputs, folder, dirs_exist_ok=True)
                        self._run(folder, "python lab.py", 0)
                self._said[place, command] = self._run(folder, command, status)
                with (folder / "commands.sh").open("a", encoding="utf-8") as lines:
                    lines.write(f"{command}\n")
            return self._said[place, command]

    def _run(self, folder: Path, command: str, status: int) -> str:
        program, _, rest = command.partition(" ")
        done = subprocess.run(
            f"{_PROGRAMS.get(program, program)} {rest}",
            shell=True,
            cwd=folder,
            env=_environment(PYTHON=sys.executable),
            capture_output=True,
            text=True,
            check=False,
        )
        if done.returncode != status:
            raise SiteError(
                f"`{command}` ends with {done.returncode}: {done.stderr or done.stdout}"
            )
        return done.stderr if status else done.stdout


def screen(output: str, marks: Sequence[str] = ()) -> str:
    """Output as a block of a page, its long lines wrapped.

    marks : patterns; the first line that one matches ends with its number, ①, ②, … Raises SiteError for one that
    matches no line.
    """
    lines = output.rstrip().split("\n")
    for number, pattern in enumerate(marks):
        at = next((i for i, line in enumerate(lines) if re.search(pattern, line)), None)
        if at is None:
            raise SiteError(f"no line of the output matches {pattern!r}")
        lines[at] += f"  {chr(_ONE + number)}"
    wrapped = (
        [line] if re.search(r"\S {3,}\S", line) else textwrap.wrap(line, WIDTH) or [""]
        for line in lines
    )
    return "```screen\n" + "\n".join(part for parts in wrapped for part in parts) + "\n```"


@dataclass(frozen=True, slots=True)
class Section:
    """A heading of a text with the lines below it, up to the next heading of any level.

    level : number of its #, 0 for what precedes the first heading.
    """

    level: int
    title: str
    body: str

    @property
    def anchor(self) -> str:
        """The anchor of the heading in links, formed as code hosts and MyST form it."""
        return re.sub(r"[^\w\- ]", "", self.title.strip().lower().replace(" ", "-"))


def sections(text: str) -> list[Section]:
    """The sections of a text in their order, without comments; an empty first section is omitted."""
    parts: list[tuple[int, str, list[str]]] = [(0, "", [])]
    for in_code, line in _lines(_COMMENT.sub("", text)):
        if (heading := _HEADING.match(line)) and not in_code:
            parts.append((len(heading[1]), heading[2], []))
        else:
            parts[-1][2].append(line)
    cut = [Section(level, title, "".join(lines).strip("\n")) for level, title, lines in parts]
    return cut if cut[0].body else cut[1:]


def with_inner(text: list[Section], title: str) -> list[Section]:
    """The section of that title with its subsections; none if no section has that title."""
    found = list(dropwhile(lambda one: one.title != title, text))
    return found[:1] + list(takewhile(lambda one: one.level > found[0].level, found[1:]))


def written(text: list[Section]) -> str:
    """Sections as Markdown."""
    headed = ((f"{'#' * one.level} {one.title}" * bool(one.level), one.body) for one in text)
    return "\n\n".join(part for parts in headed for part in parts if part) + "\n"


def of_project(text: str, folder: str) -> str:
    """A text with its links to files rewritten as `project:PATH`, the path taken from the root of the project.

    folder : the folder of the text, from the root; "" for the root.   Links to URLs and within the text are kept.
    """

    def named(target: str, picture: bool) -> str:
        if re.match(r"[a-z]+:|#", target):
            return target
        path, mark, place = target.partition("#")
        return f"{SCHEME}{posixpath.normpath(posixpath.join(folder, path))}{mark}{place}"

    return relinked(text, named)


def relinked(text: str, new: Callable[[str, bool], str]) -> str:
    """A text with the target of every link and picture replaced, except in code.

    A link to a page under the name of a file or folder, which a reader may not have, takes the page's title.
    new : (target, whether the target is a picture) → new target.
    """

    def replaced(link: re.Match[str]) -> str:
        if not link["target"]:
            return link[0]
        target = new(link["target"], bool(link["picture"]))
        titled = _PAGE.fullmatch(target) and _PATH.fullmatch(link["before"])
        return f"{'[](' if titled else link['before']}{target})"

    blocks = (
        (in_code, "".join(line for _, line in lines))
        for in_code, lines in groupby(_lines(text), key=lambda line: line[0])
    )
    return "".join(block if in_code else _LINK.sub(replaced, block) for in_code, block in blocks)


def _lines(text: str) -> Iterator[tuple[bool, str]]:
    """The lines of a text, including their line ends, each with whether it belongs to a fenced code block."""
    fences = (token for token in MarkdownIt().parse(text) if token.type == "fence")
    in_code = {number for fence in fences for number in range(*(fence.map or ()))}
    return ((number in in_code, line) for number, line in enumerate(io.StringIO(text)))


class Pages:
    """The pages of a site, made from the templates in a folder of the project.

    functions : for templates.   copies : the folder for copies of the files to which pages link.
    parts : (text, anchor) → (page, anchor there, "" for its top); the anchor None stands for the whole text.
    """

    def __init__(self, root: Path, folder: str, functions: Mapping[str, Any], copies: Path) -> None:
        self.root, self.folder, self.functions, self.copies = root, folder, functions, copies
        self.parts: dict[tuple[str, str | None], tuple[str, str]] = {}

    def made(self) -> dict[str, str]:
        """The Markdown of each page, by its path below the folder. Raises SiteError if a page cannot be rendered."""
        pages = templates(jinja2.FileSystemLoader(self.root / self.folder))
        pages.globals |= {**self.functions, "there": self._there, "picture": self._picture}
        names = sorted(pages.list_templates(extensions=["md"]))
        with ThreadPoolExecutor(_AT_ONCE) as threads:  # some wait for commands
            rendered = list(threads.map(partial(self._rendered, pages), names))
        texts = zip(names, rendered, strict=True)
        return {name: relinked(text, partial(self._led, name)) for name, text in texts}

    def _rendered(self, pages: jinja2.Environment, name: str) -> str:
        inserted = {"text": partial(self._text, name), "section": partial(self._section, name)}
        try:
            return pages.get_template(name).render(inserted)
        except (jinja2.TemplateError, SiteError) as error:
            raise SiteError(f"{self.folder}/{name}: {error}") from error

    def _there(self, path: str) -> bool:
        return (self.root / path).is_file()

    def _picture(self, path: str, words: str) -> str:
        """A picture among the results, with what it shows in words; nothing where it was not made."""
        return f"![{words}]({SCHEME}{path})" if self._there(path) else ""

    def _sections(self, path: str) -> list[Section]:
        text = (self.root / path).read_text(encoding="utf-8")
        return sections(of_project(text, posixpath.dirname(path)))

    def _placed(self, page: str, path: str, anchor: str | None, there: str, what: str) -> None:
        """Note that a page shows a text, or a section of it. Raises SiteError where another does."""
        if (path, anchor) in self.parts:
            raise SiteError(f"{what} is on {self.parts[path, anchor][0]} already")
        self.parts[path, anchor] = (page, there)

    def _text(self, page: str, path: str) -> str:
        """A whole text, whose title becomes that of the page."""
        self._placed(page, path, None, "", path)
        return written(self._sections(path))

    def _section(self, page: str, path: str, title: str, level: int = 0, inner: bool = True) -> str:
        """A section of a text; for the title "", the opening of the text up to its first heading below the title.

        level : the level of its heading on the page; 0 for no heading.   inner : whether to include its subsections.
        """
        known = self._sections(path)
        chosen = with_inner(known, title) if title else known[:1]
        if not chosen:
            titles = ", ".join(repr(section.title) for section in known)
            raise SiteError(f"{path} has no section {title!r}; it has {titles}")
        first, others = chosen[0], chosen[1:] if inner else []
        down = (level or 1) - first.level
        if title:
            self._placed(
                page, path, first.anchor, first.anchor * bool(level), f"{title!r} of {path}"
            )
        else:
            self.parts[path, ""] = (page, "")
        self.parts |= {(path, one.anchor): (page, one.anchor) for one in others}
        others = [replace(one, level=one.level + down) for one in others]
        return written([replace(first, level=level), *others])

    def _led(self, page: str, target: str, picture: bool) -> str:
        """The target of a link; for one to a file of the project, the page that shows the file, or its copy."""
        if not target.startswith(SCHEME):
            return target
        path, _, place = target.removeprefix(SCHEME).partition("#")
        for text in (path, posixpath.join(path, "README.md")):
            part, whole = self.parts.get((text, place)), self.parts.get((text, None))
            if found := part or (whole and (whole[0], place)):
                address = posixpath.relpath(found[0], posixpath.dirname(page) or ".")
                return f"{address}#{found[1]}" if found[1] else address
        copied = self.copied(path)
        if copied is None:
            raise SiteError(
                f"{self.folder}/{page}: a link leads to {path}, which is on no page and no small file"
            )
        up = "../" * page.count("/")
        return f"{up}{EXTRA}/{copied}" if picture else f"{FILE}{up}{copied}"

    def copied(self, path: str) -> str | None:
        """The path of the copy of a file, from the root of the site; None if there is no such file or it is too large.

        An HTML page of results keeps its links to other small files; its other links are replaced by their text.
        """
        file = self.root / path
        if path.startswith("..") or not file.is_file() or file.stat().st_size > _LARGEST:
            return None

        def kept(link: re.Match[str]) -> str:
            target = posixpath.normpath(posixpath.join(posixpath.dirname(path), link[2]))
            return link[1] if self.copied(target) is None else link[0]

        copy = self.copies / FOLDER / path
        if not copy.exists():
            copy.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(file, copy)
            if file.suffix == ".html":
                text = file.read_text(encoding="utf-8")
                copy.write_text(_LOCAL_LINK.sub(kept, text), encoding="utf-8")
        return f"{FOLDER}/{path}"
