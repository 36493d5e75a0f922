"""dampbalance identify: F_k, c and K_z from records of steady responses at several levels."""

from __future__ import annotations

import argparse
import math
from pathlib import Path
from typing import Any

from ..balance import APPROACHES
from ..identification.identify import REPLICATES, SEED
from ..identification.outputs import OUTPUTS
from ..identification.run import identified, write_results

_EPILOG = """\
A record is one file per level of excitation: a channel that drives (base_displacement, base_acceleration or force) and
at least one of the mass (displacement, velocity, acceleration). Formats: CSV, TSV, Parquet, MATLAB, HDF5, universal
file 58, TDMS, WAV. What a file does not say of its channels stands in a small YAML file beside it, NAME.yaml or
channels.yaml.

  dampbalance identify level*.csv --stiffness 2310 --frequency 3.5 --output found
"""


def add_to(commands: Any) -> None:
    """Add the command to the parser."""
    parser = commands.add_parser(
        "identify",
        help="identify F_k, c and K_z from records",
        description=__doc__,
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add = parser.add_argument
    add(
        "records", nargs="+", type=Path, metavar="RECORD", help="a file, one per level; two or more"
    )
    add("--stiffness", type=_positive, required=True, metavar="K", help="stiffness k, N/m")
    add(
        "--frequency",
        type=_positive,
        metavar="HZ",
        help="drive frequency as known, Hz; compared with the one found in each record",
    )
    add(
        "--approach",
        action="append",
        choices=list(APPROACHES),
        help="an approach; may be repeated (default: all)",
    )
    add(
        "--phase",
        choices=["reversal", "zero_crossing", "fundamental"],
        default="reversal",
        help="phase φ that the approaches X_s, t_s and V_s take (default: reversal)",
    )
    add(
        "--mass",
        type=_positive,
        metavar="M",
        help="mass, kg: adds the maximum-likelihood fit of the whole oscillator as a yardstick",
    )
    add(
        "--mapping",
        type=Path,
        metavar="FILE",
        help="channels of all records (default: beside each)",
    )
    add(
        "--skip-cycles",
        type=_count,
        default=0,
        metavar="N",
        help="cycles left out at the start of each record (default: 0)",
    )
    add(
        "--replicates",
        type=_count,
        default=REPLICATES,
        help="of the bootstrap (default: %(default)s)",
    )
    add("--seed", type=_count, default=SEED, help="of the bootstrap (default: %(default)s)")
    add("--output", type=Path, metavar="DIR", help=f"write {', '.join(OUTPUTS)} there")
    add("--overwrite", action="store_true", help="replace results that are there already")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> None:
    """Identify, show the table, write the results."""
    folder: Path | None = options.output
    if folder is not None and not options.overwrite:
        there = [name for name in OUTPUTS if (folder / name).exists()]
        if there:
            raise ValueError(
                f"{folder} holds {there[0]} already: choose another folder, or add --overwrite"
            )
    results = identified(
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
    print(results.text(), end="")
    if folder is not None:
        write_results(results, folder)
        print(f"\nWritten to {folder}: {', '.join(OUTPUTS)}.")


def _positive(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not (math.isfinite(value) and value > 0.0):
        raise argparse.ArgumentTypeError(f"must be a positive number, got {text!r}")
    return value


def _count(text: str) -> int:
    try:
        value = int(text)
    except ValueError:
        value = -1
    if value < 0:
        raise argparse.ArgumentTypeError(f"must be 0 or a positive whole number, got {text!r}")
    return value
