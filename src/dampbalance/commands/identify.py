"""dampbalance identify: F_k, c and K_z from records of steady responses at several levels or of free decays, or from
tables of a stepped sine.

A record is one file per level of excitation: a channel that drives (base_displacement, base_velocity, base_acceleration
or force) and at least one of the mass (displacement, velocity, acceleration; relative_displacement, … where it was
measured against the base). Formats: CSV, TSV, Parquet, MATLAB, HDF5, universal file 58, TDMS, LabVIEW's text, WAV,
NumPy, JSON, spreadsheets. Where a file does not describe its channels, a small YAML file next to it does, NAME.yaml or
channels.yaml; --write-mapping drafts one for you to correct.

  dampbalance identify level*.csv --stiffness 2310 --frequency 3.5 --output found

A record whose driving channel is missing, or shows only noise or blows of a hammer, is taken for free decays after
releases or blows:

  dampbalance identify decay.csv --stiffness 2310

Records of an angle, an angular velocity (rpm, °/s) or a torque belong to a rotating oscillator: give its stiffness in
N m/rad, and as its mass the moment of inertia in kg m²; the friction torque is called T_k:

  dampbalance identify pendulum.csv --stiffness 1.18 --mass 0.019

A table of a stepped sine has a line for each steady response, with columns of frequency, amplitude of force or base,
amplitude of the response, phase, and level; with a force it needs no stiffness:

  dampbalance identify levels.csv

Loops of force against displacement, from a test machine, need no stiffness:

  dampbalance identify loops.csv

A table of mean forces or torques at steady speeds in both directions, of a robot joint or a tribometer, without times:

  dampbalance identify speeds.csv

Numbers may have a unit, and k, m and the normal force a standard uncertainty: "5.2 N/mm ± 1 %", 2310±10, "210 rpm".

The exit status is 0 with an answer, 1 where the records give none (the cause is shown first), 2 for an error.
"""

from __future__ import annotations

import argparse
import shutil
import sys
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, get_args

from ..identification.outputs import ALL_PICTURES, OUTPUTS, REPORT, TABLES, require_room
from ..project.files import json_text, replacing, write_text
from ..project.options import IN_WORDS, OPTIONS, Option
from ..project.spelling import in_a_shell
from ..project.wording import listed
from ..records.quantities import with_error
from .options import FILE, argument, coefficients, labels, read_by, whole

_SCREEN = Path("-")


@in_a_shell()
def run(options: argparse.Namespace) -> bool:
    """Identify, show the table or the document, and write the results; or write a mapping.

    Returns whether there is an answer.
    """
    if options.write_mapping is not None:
        _write_mapping(options)
        return True
    from ..measured import identify  # slow to import, not needed for help

    folder: Path | None = options.output
    document: Path | None = None if options.json == _SCREEN else options.json
    # before anything is computed
    permission = "" if options.overwrite else "--overwrite"
    if folder is not None:
        require_room(folder, (*TABLES, *ALL_PICTURES), permission)
    for file in filter(None, (document, options.report)):
        require_room(file.parent, [file.name], permission)
    stated = {name: of for name, of in vars(options).items() if name in OPTIONS}
    stated |= {name: _together(name, of) for name, of in stated.items() if isinstance(of, list)}
    result = identify(options.records, kind=options.kind, **stated)
    answer = json_text(result.document())
    shown, width = answer, shutil.get_terminal_size().columns
    if options.json != _SCREEN:
        shown = result.text(width) if options.details else result.screen(width)
    print(shown, end="", file=options.screen if options.json == _SCREEN else None)
    places, drawn = options.written, ""
    if document is not None:
        write_text(document, answer)
        places.append(str(document))
    if folder is not None:
        files = result.save(folder, figures=not options.no_figures, overwrite=options.overwrite)
        names = [of.name for of in files if of.name not in ALL_PICTURES or of.name == REPORT]
        pictures = [f"{len(files) - len(names)} pictures"] * (len(files) > len(names))
        places.append(f"{folder}: {listed([*names, *pictures])}")
        drawn = "" if options.no_figures else (folder / REPORT).read_text(encoding="utf-8")
    if options.report is not None:
        write_text(options.report, drawn or result.report())
        places.append(str(options.report))
    if places:
        stream = sys.stderr if options.json == _SCREEN else sys.stdout
        print(f"\nWritten to {'; '.join(places)}.", file=stream)
    return not result.no_answer


def _write_mapping(options: argparse.Namespace) -> None:
    """Write a mapping for the first record that the others can be read with, show it, and say how it is used."""
    from ..records.mapping import BLANK, find_mapping, mapping_for, read_mapping
    from ..records.measured import files_of
    from ..records.readers import mapping_to_start_from, quantities_of

    records = [*files_of(options.records, getattr(options, "mapping", None))]
    file: Path = options.write_mapping
    if file.suffix != ".yaml":
        raise ValueError(f"--write-mapping {file}: the name of a mapping must end in .yaml")
    stepped = None if options.kind == "recognised" else options.kind == "stepped-sine"
    require_room(file.parent, [file.name], "" if options.overwrite else "--overwrite")
    known = mapping_for(records[0], getattr(options, "mapping", None))
    known = replace(known, kind=options.kind)
    text = mapping_to_start_from(records[0], known, stepped)
    with replacing(file) as unfinished:
        unfinished.write_text(text, encoding="utf-8", newline="\n")
        blanks = f'{BLANK}"' in text
        of_file = {"source": str(file), "kind": options.kind}
        mapping = None if blanks else replace(read_mapping(unfinished), **of_file)
        for record in records if mapping and mapping.channels else ():
            quantities_of(record, mapping)
    is_usual = all(find_mapping(record) == file for record in records)
    use = "without --write-mapping" if is_usual else f"with --mapping {file} instead"
    todo = f'Fill in what "{BLANK}" stands for' if blanks else "Check each line"
    options.written.append(str(file))
    print(f"{text}\nWritten to {file}. {todo}, then give the same command {use}.")


def _written(option: Option) -> Callable[[str], str]:
    """Return a type of argument: a number as it stands, with its unit, its uncertainty and its digits."""

    def checked(name: str, text: str) -> str:
        with_error(name, text, option.bounds)
        return text

    return read_by(checked, option.name)


def _together(name: str, parts: list[dict[str, Any]]) -> dict[str, Any]:
    """Return the terms of an option that may be repeated. Raises ValueError for a term that is named twice."""
    together: dict[str, Any] = {}
    for part in parts:
        if twice := together.keys() & part.keys():
            raise ValueError(f"--{name}: {twice.pop()} is named twice: leave out one of the two")
        together |= part
    return together


_FORMS: Mapping[str, Callable[[Option], dict[str, Any]]] = {
    "flag": lambda of: {"action": argparse.BooleanOptionalAction},
    "whole": lambda of: {"type": whole(of.name, of.bounds), "metavar": "N"},
    "number": lambda of: {"type": _written(of), "metavar": of.unit},
    "stated": lambda of: {"type": _written(of), "metavar": of.unit},
    "path": lambda of: FILE,
    "names": lambda of: {"metavar": of.name.upper()},
    "coefficients": lambda of: {"type": coefficients, "action": "append", "metavar": "TERM=VALUE"},
    "labels": lambda of: {"type": labels, "action": "append", "metavar": "TERM=A,A,B"},
    "choice": lambda of: {"choices": get_args(of.type)},
}
"""Form of the value of an option → what argparse takes of it."""


def _argument(option: Option) -> dict[str, Any]:
    """Return what argparse takes of an option. One that is not given leaves no trace: the functions that identify know
    its default."""
    form = _FORMS[option.form](option)
    words, default, kinds = option.words, option.default, [IN_WORDS[kind] for kind in option.kinds]
    if isinstance(default, bool):
        words += f" (default: {'yes' if default else 'no'})"
    elif default is not None:
        words += f" (default: {default})"
    words += "; may be repeated" * (form.get("action") == "append")
    group = _ALL if len(kinds) == len(IN_WORDS) else listed(kinds, "or")
    return argument(words.replace("%", "%%"), group=group, default=argparse.SUPPRESS, **form)


_ALL = "all records"
_RESULTS = {
    "--details": argument("show all answers and all that limits them, instead of one screen"),
    "--output": argument(f"write {', '.join(OUTPUTS)} there", type=Path, metavar="DIR"),
    "--no-figures": argument("write no pictures: they take longer than all the rest"),
    "--json": argument(
        f"write {TABLES[0]} to this file as well; - shows it instead of the table", **FILE
    ),
    "--report": argument(
        "write the report, one page of HTML with everything, to this file", **FILE
    ),
    "--overwrite": argument("replace existing results"),
}

ARGUMENTS: dict[str, dict[str, Any]] = {
    "records": argument(
        "one file per level, at least as many as coefficients, or their folder; one for a free decay",
        nargs="+",
        type=Path,
        metavar="RECORD",
    ),
    "--kind": argument(
        f"{listed(list(IN_WORDS.values()), 'or')} (default: recognised)",
        group=_ALL,
        choices=tuple(IN_WORDS),
        default="recognised",
    ),
    "--write-mapping": argument(
        "write a draft of a mapping to this file, with a reason for each channel, and do nothing else",
        **{"group": _ALL, **FILE},
    ),
    **{f"--{name.replace('_', '-')}": _argument(option) for name, option in OPTIONS.items()},
    **{name: {"group": "results", **own} for name, own in _RESULTS.items()},
}
