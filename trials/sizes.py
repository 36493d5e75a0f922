"""Write the sizes of the project into the tables of CONTRIBUTING.md: lines of code, and how long `make` takes.

    make sizes               lines of code of each room and folder
    make sizes MEASURE=1     also the times, in a clone of the last commit, without caches of pip and uv: ten minutes

A line of code is not empty and neither a comment nor part of a docstring.
"""

from __future__ import annotations

import ast
import os
import re
import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping
from datetime import date
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "CONTRIBUTING.md"
COMMANDS = ("make", "make clean all", "make setup", "make test")
"""What is timed, in this order; the third, which installs the tools of the fourth, has no row on the page."""
ROW = re.compile(r"^(\| `([^`]+)`.*\|) *([^|]*?) *\|$", re.MULTILINE)
"""A row of the tables: all but its last cell, the first name in it, the last cell."""


def lines_of_code(text: str) -> int:
    """Count the lines of a module that hold code."""
    texts = [node.value for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Expr)]
    documented = {
        line
        for of in texts
        if isinstance(of, ast.Constant) and isinstance(of.value, str)
        for line in range(of.lineno, (of.end_lineno or 0) + 1)
    }
    written = enumerate(map(str.strip, text.splitlines()), 1)
    return sum(line[:1] not in ("", "#") and n not in documented for n, line in written)


def size_of(place: str) -> str:
    """Return the lines of code in a folder of the package or of the project, or in the files of a pattern."""
    found = [path for top in (ROOT / "src/dampbalance", ROOT) for path in top.glob(place)]
    modules = [one for path in found for one in (path.rglob("*.py") if path.is_dir() else [path])]
    return f"{sum(lines_of_code(of.read_text('utf-8')) for of in modules):,}" if modules else ""


def rewritten(text: str, measured: Mapping[str, str]) -> str:
    """Return the page with the last cell of each row: what was measured of the first name in the row, or its lines of
    code; a cell for which there is neither stays."""
    head, mark, rest = text.partition("<!-- sizes")
    tables, end, tail = rest.partition("<!-- end")

    def sized(row: re.Match[str]) -> str:
        return f"{row[1]} {measured.get(row[2]) or size_of(row[2]) or row[3]} |"

    return head + mark + ROW.sub(sized, tables) + end + tail


def times() -> dict[str, str]:
    """Run each command in a fresh clone and return how long it took."""
    taken = {}
    settings = {name: value for name, value in os.environ.items() if "MAKE" not in name}
    settings |= {"UV_NO_CACHE": "1", "PIP_NO_CACHE_DIR": "1"}
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run(["git", "clone", "--quiet", ROOT, folder], check=True)
        for command in COMMANDS:
            start = time.monotonic()
            subprocess.run(command.split(), cwd=folder, env=settings, check=True, stdout=sys.stderr)
            minutes, seconds = divmod(round(time.monotonic() - start), 60)
            taken[command] = f"{minutes} min {seconds} s" if minutes else f"{seconds} s"
    return taken


if __name__ == "__main__":
    measured = times() if "--measure" in sys.argv[1:] else {}
    page = rewritten(PAGE.read_text(encoding="utf-8"), measured)
    if measured:
        stated = f"{len(os.sched_getaffinity(0))} cores, {date.today().isoformat()}"
        page = re.sub(r"\d+ cores, \d{4}-\d\d-\d\d", stated, page)
    PAGE.write_text(page, encoding="utf-8")
