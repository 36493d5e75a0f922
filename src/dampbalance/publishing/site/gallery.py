"""Lists the studies with title, figure and result, or with the command that computes them if there is no result yet."""

from __future__ import annotations

import re
from pathlib import Path

from ...project.documents import read_yaml
from ...project.wording import in_markdown

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
