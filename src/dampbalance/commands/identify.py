"""dampbalance identify: F_k, c and K_z from records of steady responses at several levels."""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any, get_args

from ..balance import APPROACHES
from ..features import Phase
from ..identification.identify import REPLICATES, SEED
from ..identification.outputs import OUTPUTS

EPILOG = """\
A record is one file per level of excitation: a channel that drives (base_displacement, base_acceleration or force) and
at least one of the mass (displacement, velocity, acceleration). Formats: CSV, TSV, Parquet, MATLAB, HDF5, universal
file 58, TDMS, WAV. What a file does not say of its channels stands in a small YAML file beside it, NAME.yaml or
channels.yaml.

  dampbalance identify level*.csv --stiffness 2310 --frequency 3.5 --output found
"""


_HELP = f"""\
records         a file, one per level; two or more
--stiffness     stiffness k, N/m
--frequency     drive frequency as known, Hz; compared with the one found in each record
--approach      an approach; may be repeated (default: all)
--phase         phase φ that the approaches X_s, t_s and V_s take (default: reversal)
--mass          mass, kg: adds the maximum-likelihood fit of the whole oscillator as a yardstick
--mapping       channels of all records (default: beside each)
--skip-cycles   cycles left out at the start of each record (default: 0)
--replicates    of the bootstrap (default: %(default)s)
--seed          of the bootstrap (default: %(default)s)
--output        write {", ".join(OUTPUTS)} there
--overwrite     replace results that are there already
"""


def run(options: argparse.Namespace) -> None:
    """Identify, show the table, write the results."""
    from ..identification.run import (
        identify_files,
        write_results,
    )  # slow to import, not needed for help

    folder: Path | None = options.output
    if folder is not None and not options.overwrite:
        there = [name for name in OUTPUTS if (folder / name).exists()]
        if there:
            raise ValueError(
                f"{folder} holds {there[0]} already: choose another folder, or add --overwrite"
            )
    result = identify_files(
        options.records,
        options.stiffness,
        mapping=options.mapping,
        frequency_hz=options.frequency,
        skip_cycles=options.skip_cycles,
        approaches=options.approach,
        phase=options.phase,
        mass=options.mass,
        replicates=options.replicates,
        seed=options.seed,
    )
    print(result.text(), end="")
    if folder is not None:
        write_results(result, folder)
        print(f"\nWritten to {folder}: {', '.join(OUTPUTS)}.")


def _number(kind: Callable[[str], float], fits: Callable[[float], bool], wanted: str) -> Any:
    """A type of argument: a number of this kind, or an error that says what is wanted."""

    def read(text: str) -> float:
        try:
            value = kind(text)
        except ValueError:
            value = -1
        if not fits(value):
            raise argparse.ArgumentTypeError(f"must be {wanted}, got {text!r}")
        return value

    return read


_positive = _number(float, lambda value: 0.0 < value < math.inf, "a positive number")
_count = _number(int, lambda value: value >= 0, "0 or a positive whole number")

_OPTIONS: dict[str, dict[str, Any]] = {
    "records": {"nargs": "+", "type": Path, "metavar": "RECORD"},
    "--stiffness": {"type": _positive, "required": True, "metavar": "K"},
    "--frequency": {"type": _positive, "metavar": "HZ"},
    "--approach": {"action": "append", "choices": list(APPROACHES)},
    "--phase": {"choices": get_args(Phase), "default": "reversal"},
    "--mass": {"type": _positive, "metavar": "M"},
    "--mapping": {"type": Path, "metavar": "FILE"},
    "--skip-cycles": {"type": _count, "default": 0, "metavar": "N"},
    "--replicates": {"type": _count, "default": REPLICATES},
    "--seed": {"type": _count, "default": SEED},
    "--output": {"type": Path, "metavar": "DIR"},
    "--overwrite": {"action": "store_true"},
}
ARGUMENTS = {
    name: _OPTIONS[name] | {"help": words}
    for name, words in (line.split(maxsplit=1) for line in _HELP.splitlines())
}
