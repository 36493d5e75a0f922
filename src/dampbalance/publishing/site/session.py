"""Commands that run while the site is built: a page shows what they say and write, not what once was typed."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
import textwrap
from collections import defaultdict
from collections.abc import Sequence
from pathlib import Path
from threading import Lock
from typing import Any

from .pages import SiteError

WIDTH = 112  # letters of a line of output that is not a row of a table
_ONE = 0x2460  # ①
_PROGRAM = re.compile(r"^(?:dampbalance|python)\b")


class Session:
    """Shells below a folder, each in its place. A command that a second page shows is not run again.

    folder : for the files, which the site holds.   source : where the package is.   inputs : folder of files to start
    from; its programs write the others.
    """

    def __init__(self, folder: Path, source: Path, inputs: Path) -> None:
        self.folder, self.source, self.inputs = folder, source, inputs
        self._said: dict[tuple[str, str], str] = {}
        self._busy: defaultdict[str, Lock] = defaultdict(Lock)

    def run(self, place: str, command: str, status: int = 0) -> str:
        """What a command says in the folder `place`; its line stands in commands.sh there.

        status : which it ends with.   Raises SiteError where it ends with another.
        """
        with self._busy[place]:
            if (place, command) not in self._said:
                folder = self.folder / place
                if not folder.exists():
                    self._start(folder)
                self._said[place, command] = self._run(folder, command, status)
                with (folder / "commands.sh").open("a", encoding="utf-8") as lines:
                    lines.write(f"{command}\n")
            return self._said[place, command]

    def document(self, path: str) -> Any:
        """What a JSON file holds that a command has written."""
        return json.loads((self.folder / path).read_text(encoding="utf-8"))

    def _start(self, folder: Path) -> None:
        folder.mkdir(parents=True)
        inputs = self.inputs / folder.name
        if inputs.is_dir():
            shutil.copytree(inputs, folder, dirs_exist_ok=True)
            self._run(folder, "python lab.py", 0)

    def _run(self, folder: Path, command: str, status: int) -> str:
        paths = filter(None, [str(self.source), os.environ.get("PYTHONPATH")])
        environment = os.environ | {"PYTHONPATH": os.pathsep.join(paths), "PYTHON": sys.executable}
        line = _PROGRAM.sub(lambda word: _PROGRAMS[word[0]], command)
        done = subprocess.run(
            line,
            shell=True,
            cwd=folder,
            env=environment,
            capture_output=True,
            text=True,
            check=False,
        )
        if done.returncode != status:
            raise SiteError(
                f"`{command}` ends with {done.returncode}: {done.stderr or done.stdout}"
            )
        return done.stderr if status else done.stdout


_PROGRAMS = {"python": '"$PYTHON"', "dampbalance": '"$PYTHON" -m dampbalance'}


def shown(output: str, marks: Sequence[str] = ()) -> str:
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
