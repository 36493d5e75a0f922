"""dampbalance demo: example records, their identification and its report, within seconds.

Five records of the paper's oscillator below its resonance are simulated, with 1 % of noise, and identified by the
command that is shown: repeat it with records and a stiffness of your own.

  dampbalance demo --open
"""

from __future__ import annotations

import argparse
import shlex
import webbrowser
from pathlib import Path
from typing import Any

from ..identification.outputs import REPORT, require_room
from .main import parser
from .options import argument
from .simulate import CONTACT, DAMPING, FRICTION, MASS, STIFFNESS

ARGUMENTS: dict[str, dict[str, Any]] = {
    "folder": argument(
        "where records and results go (default: %(default)s)",
        nargs="?",
        type=Path,
        default=Path("dampbalance-demo"),
        metavar="FOLDER",
    ),
    "--open": argument("show the report in the browser"),
    "--overwrite": argument("replace existing records and results"),
}

_LEVELS_MM = (4, 6, 8, 10, 12)
_RECORD = shlex.split(
    "--frequency 3.5 --rate 1000 --cycles 20 --noise 0.01 --start 0.1 --decimals 6 "
    "--channel base_displacement --channel displacement --channel acceleration"
)
"""Options of each record, as for those in config/records/example."""


def run(options: argparse.Namespace) -> None:
    """Simulate, identify, and say where the report is, or show it."""
    folder: Path = options.folder
    records = [folder / f"level{level}.csv" for level, _ in enumerate(_LEVELS_MM, start=1)]
    results = folder / "found"
    again = ["--overwrite"] * options.overwrite
    names = [file.name for file in (*records, results)]
    require_room(folder, names, "" if again else "--overwrite")
    for seed, (record, level) in enumerate(zip(records, _LEVELS_MM, strict=True), start=1):
        motion = ("--amplitude", f"{level / 1000:g}", "--seed", f"{seed}")
        _run(options, "simulate", str(record), *motion, *_RECORD, *again)
    given = ["--stiffness", f"{STIFFNESS:g}", "--mass", f"{MASS:g}", "--frequency", "3.5"]
    given += ["--output", str(results)]
    report = results / REPORT
    print(f"\n$ dampbalance identify {shlex.quote(str(folder))}/level*.csv {shlex.join(given)}")
    _run(options, "identify", *map(str, records), *given, *again)
    print(
        f"\nThe records were made with F_k = {FRICTION:g} N, c = {DAMPING:g} N s/m and K_z = {CONTACT:g} N/m: compare "
        f"the first line.\nThe report is {report}. Repeat the command above with records of your own."
    )
    if options.open:
        webbrowser.open(report.resolve().as_uri())


def _run(options: argparse.Namespace, name: str, *arguments: str) -> None:
    """Run another command of this room with these arguments, as a part of this one."""
    own = parser([name]).parse_args([name, *arguments])
    try:
        own.run(own)
    finally:
        options.written += own.written
