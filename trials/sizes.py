"""Write the sizes of the project into the table of CONTRIBUTING.md: lines of code, and how long `make` takes.

    make sizes               lines of code of each room and folder
    make sizes MEASURE=1     also the times, in a clone of the last commit and without the caches of pip and uv (ten minutes)

A line of code holds a token that is neither a comment nor part of a docstring.
"""

from __future__ import annotations

import argparse
import ast
import io
import os
import re
import subprocess
import tempfile
import time
import tokenize
from collections.abc import Mapping
from datetime import date
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "CONTRIBUTING.md"
CORES = len(os.sched_getaffinity(0))
COMMANDS = ("make", "make clean all", "make setup", "make test")
"""What is timed, in this order; the page has a row for each except the third, which installs the tools of the fourth."""
ROW = re.compile(r"^(\| `([^`]+)`.*\|) *([^|]*?) *\|$", re.MULTILINE)
"""A row of the tables of sizes: all but its last cell, the first name in it, the last cell."""
NO_CODE = {
    *(tokenize.COMMENT, tokenize.NL, tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT),
    tokenize.ENDMARKER,
}


def lines_of_code(text: str) -> int:
    """Count the lines of a module that hold code."""
    documented = {
        line
        for node in ast.walk(ast.parse(text))
        if isinstance(node, ast.Expr)
        and isinstance(node.value, ast.Constant)
        and isinstance(node.value.value, str)
        for line in range(node.lineno, (node.end_lineno or node.lineno) + 1)
    }
    tokens = tokenize.generate_tokens(io.StringIO(text).readline)
    spans = [range(t.start[0], t.end[0] + 1) for t in tokens if t.type not in NO_CODE]
    return len({line for span in spans for line in span} - documented)


def size_of(place: str) -> str:
    """Return the lines of code in a folder of the package or of the project, or in the files of a pattern."""
    found = [path for top in (ROOT / "src/dampbalance", ROOT) for path in top.glob(place)]
    modules = [
        module for path in found for module in ([path] if path.is_file() else path.rglob("*"))
    ]
    texts = [module.read_text(encoding="utf-8") for module in modules if module.suffix == ".py"]
    return f"{sum(map(lines_of_code, texts)):,}" if texts else ""


def rewritten(text: str, measured: Mapping[str, str]) -> str:
    """Return the page with the last cell of each row of its tables of sizes: what was measured of the first name in the
    row, or its lines of code; the cell stays where there is neither."""
    head, mark, rest = text.partition("<!-- sizes")
    tables, end, tail = rest.partition("<!-- end")

    def sized(row: re.Match[str]) -> str:
        return f"{row[1]} {measured.get(row[2]) or size_of(row[2]) or row[3]} |"

    return head + mark + ROW.sub(sized, tables) + end + tail


def times() -> dict[str, str]:
    """Run each command in a fresh clone and return how long it took."""
    taken = {}
    settings = {name: value for name, value in os.environ.items() if "MAKE" not in name}
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run(["git", "clone", "--quiet", ROOT, folder], check=True)
        for command in COMMANDS:
            start = time.monotonic()
            env = {**settings, "UV_NO_CACHE": "1", "PIP_NO_CACHE_DIR": "1"}
            subprocess.run(
                command.split(), cwd=folder, env=env, check=True, stdout=subprocess.DEVNULL
            )
            minutes, seconds = divmod(round(time.monotonic() - start), 60)
            taken[command] = f"{minutes} min {seconds} s" if minutes else f"{seconds} s"
    return taken


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description="Write the sizes into CONTRIBUTING.md.")
    parser.add_argument("--measure", action="store_true", help="also the times of make")
    measured = times() if parser.parse_args().measure else {}
    page = rewritten(PAGE.read_text(encoding="utf-8"), measured)
    if measured:
        stated = f"{CORES} cores, {date.today().isoformat()}"
        page = re.sub(r"\d+ cores, \d{4}-\d\d-\d\d", stated, page)
    PAGE.write_text(page, encoding="utf-8")
