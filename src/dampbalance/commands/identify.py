"""dampbalance identify: F_k, c and K_z from records of steady responses at several levels or of free decays, or from
tables of a stepped sine."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import Any

from ..balance import checks
from ..identification.outputs import ALL_PICTURES, OUTPUTS, REPORT, TABLES, require_room
from ..law.terms import KNOWN_TERMS
from ..project.files import json_text, replacing, write_text
from ..project.wording import shortened
from .options import coefficients, mass, number, whole, with_error

EPILOG = """\
A record is one file per level of excitation: a channel that drives (base_displacement, base_acceleration or force) and
at least one of the mass (displacement, velocity, acceleration; relative_displacement, … where it was measured against
the base). Formats: CSV, TSV, Parquet, MATLAB, HDF5, universal file 58, TDMS, LabVIEW's text, WAV, NumPy,
JSON, spreadsheets. What a file does not say of its channels stands in a small YAML file next to it, NAME.yaml or
channels.yaml, which --write-mapping writes for you to correct.

  dampbalance identify level*.csv --stiffness 2310 --frequency 3.5 --output found

A record whose driving channel is missing, or holds noise or the blows of a hammer alone, is one of free decays, one or
several after releases or blows:

  dampbalance identify decay.csv --stiffness 2310

A table of a stepped sine has a line for each steady response, with columns of frequency, amplitude of force or base,
amplitude of the response, phase, and level; with a force it needs no stiffness:

  dampbalance identify levels.csv
"""


_HELP = f"""\
records         a file, one per level; as many as there are coefficients, or more; of a free decay one is enough
--kind          forced records, free decays, or tables of a stepped sine (default: as the first record is recognised)
--stiffness     stiffness k, N/m, or with its standard uncertainty, 2310±10; it scales F_k and c; --mass tests it
--contact       of a stepped sine: one slider, many that slip one after the other, or the one that the lines support
--no-hardening  of a stepped sine: the spring does not stiffen with the amplitude
--residual      of a stepped sine: other modes of the structure move the driven point, too
--frequency     known drive frequency, Hz; compared with the one found in each record
--terms         of the damping law, such as F_k,c,c_2 (default: F_k,c); known: {", ".join(KNOWN_TERMS)}
--given         a coefficient that is known, such as c=0.669, SI; may be repeated
--groups        a coefficient for each group of records: F_k=A,A,B, a label per record; may be repeated
--laws          compare laws of one or two terms, with and without friction, and name the one that the records support
--approach      an approach; may be repeated (default: all)
--mass          mass, kg, or with its standard uncertainty, 2.42±0.01; alone, half its last digit or 0.5 %%, the larger
--write-mapping write a mapping to start from to this file, with a reason for each channel, and do nothing else
--mapping       file or folder that names the channels of the records (default: the file next to each)
--skip-cycles   cycles left out at the start of each record, where the motion has not settled (default: 0)
--output        write {", ".join(OUTPUTS)} there
--no-figures    write no pictures: they take longer than all the rest
--json          write {TABLES[0]} to this file, too; - shows it instead of the table
--report        write the report, one page of HTML with everything, to this file
--overwrite     replace results that are there already
"""

_SCREEN = Path("-")
_SETTINGS = (
    *("kind", "mapping", "frequency", "mass", "terms", "laws", "approaches"),
    *("contact", "hardening", "residual", "skip_cycles"),
)
"""What `identify` takes as it stands in the options."""


def run(options: argparse.Namespace) -> None:
    """Identify, show the table or the document, write the results; or write a mapping."""
    needed = ["records"] + ["--stiffness"] * (options.write_mapping is None)
    missing = [name for name in needed if not getattr(options, name.strip("-"))]
    if missing == ["--stiffness"] and _of_tables(options):
        missing = []
    if missing:
        names = ", ".join(missing).replace("records", "RECORD")
        hint = "; a stepped sine with a force needs none: add --kind stepped-sine" * (
            "--stiffness" in missing
        )
        raise ValueError(f"the following arguments are required: {names}{hint}")
    if options.write_mapping is not None:
        _write_mapping(options)
        return
    from ..identification.measured import identify  # slow to import, not needed for help

    folder: Path | None = options.output
    document: Path | None = None if options.json == _SCREEN else options.json
    # before anything is computed
    permission = "" if options.overwrite else "--overwrite"
    if folder is not None:
        require_room(folder, (*TABLES, *ALL_PICTURES), permission)
    for file in filter(None, (document, options.report)):
        require_room(file.parent, [file.name], permission)
    result = identify(
        options.records,
        options.stiffness,
        given=_once((one for some in options.given for one in some.items()), "--given"),
        groups=_once(options.groups, "--groups"),
        **{name: getattr(options, name) for name in _SETTINGS},
    )
    said = json_text(result.document())
    print(said if options.json == _SCREEN else result.text(), end="")
    places, drawn = [], ""
    if document is not None:
        write_text(document, said)
        places.append(str(document))
    if folder is not None:
        files = result.save(folder, figures=not options.no_figures, overwrite=options.overwrite)
        places.append(f"{folder}: {', '.join(file.name for file in files)}")
        drawn = "" if options.no_figures else (folder / REPORT).read_text(encoding="utf-8")
    if options.report is not None:
        write_text(options.report, drawn or result.report())
        places.append(str(options.report))
    if places:
        stream = sys.stderr if options.json == _SCREEN else sys.stdout
        print(f"\nWritten to {'; '.join(places)}.", file=stream)


def _of_tables(options: argparse.Namespace) -> bool:
    """Whether the records are tables of a stepped sine: as stated, or as the first is recognised."""
    from ..records.measured import recognised_as_table  # slow to import

    if options.kind != "recognised":
        return bool(options.kind == "stepped-sine")
    return recognised_as_table(options.records[0], options.mapping)


def _write_mapping(options: argparse.Namespace) -> None:
    """Write a mapping for the first record that the others can be read with, show it, and say how it is used."""
    from ..records.mapping import find_mapping, read_mapping  # slow to import
    from ..records.readers import mapping_to_start_from, quantities_of

    file: Path = options.write_mapping
    if file.suffix != ".yaml":
        raise ValueError(f"--write-mapping {file}: a mapping ends in .yaml; choose such a name")
    if _of_tables(options):
        raise ValueError(
            f"{options.records[0]} is a table of a stepped sine, and --write-mapping writes a mapping for signals: "
            "name the columns under `table` where they are not recognised"
        )
    require_room(file.parent, [file.name], "" if options.overwrite else "--overwrite")
    text = mapping_to_start_from(options.records[0], options.mapping)
    with replacing(file) as unfinished:
        unfinished.write_text(text, encoding="utf-8", newline="\n")
        mapping = replace(read_mapping(unfinished), source=str(file))
        for record in options.records:
            quantities_of(record, mapping)
    is_usual = all(find_mapping(record) == file for record in options.records)
    use = "without --write-mapping" if is_usual else f"with --mapping {file} instead"
    print(f"{text}\nWritten to {file}. Check each line, then give the same command {use}.")


def _labels(text: str) -> tuple[str, str]:
    """A type of argument: a term and a label for each record, F_k=A,A,B."""
    name, equals, labels = text.partition("=")
    if not equals:
        raise argparse.ArgumentTypeError(
            f"must be TERM=LABELS with a label for each record, as in F_k=A,A,B, got {shortened(text)}"
        )
    return name.strip(), labels


def _once(named: Iterable[tuple[str, Any]], option: str) -> dict[str, Any]:
    """Options of one term each as a mapping. Raises ValueError for a term that is named twice."""
    values: dict[str, Any] = {}
    for name, value in named:
        if name in values:
            raise ValueError(f"{option} names {name} twice: leave out one of the two")
        values[name] = value
    return values


_SEVERAL: dict[str, Any] = {"action": "append", "default": []}
_OPTIONS: dict[str, dict[str, Any]] = {
    "records": {"nargs": "*", "type": Path, "metavar": "RECORD"},
    "--kind": {"choices": ("forced", "ring-down", "stepped-sine"), "default": "recognised"},
    "--stiffness": {"type": with_error, "metavar": "K"},
    "--contact": {"choices": ("both", "one slider", "gradual"), "default": "both"},
    "--no-hardening": {"action": "store_false", "dest": "hardening"},
    "--residual": {"action": "store_true"},
    "--frequency": {"type": number(1e-9, 1e9), "metavar": "HZ"},
    "--terms": {"metavar": "TERMS"},
    "--given": {"type": coefficients, **_SEVERAL, "metavar": "TERM=VALUE"},
    "--groups": {"type": _labels, **_SEVERAL, "metavar": "TERM=LABELS"},
    "--laws": {"action": "store_true"},
    "--approach": {"action": "append", "choices": list(checks()), "dest": "approaches"},
    "--mass": {"type": mass, "metavar": "M"},
    "--write-mapping": {"type": Path, "metavar": "FILE"},
    "--mapping": {"type": Path, "metavar": "FILE"},
    "--skip-cycles": {"type": whole(), "default": 0, "metavar": "N"},
    "--output": {"type": Path, "metavar": "DIR"},
    "--no-figures": {"action": "store_true"},
    "--json": {"type": Path, "metavar": "FILE"},
    "--report": {"type": Path, "metavar": "FILE"},
    "--overwrite": {"action": "store_true"},
}
ARGUMENTS = {
    name: _OPTIONS[name] | {"help": words}
    for name, words in (line.split(maxsplit=1) for line in _HELP.splitlines())
}
