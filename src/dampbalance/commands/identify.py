"""dampbalance identify: F_k, c and K_z from records of steady responses at several levels or of free decays, or from
tables of a stepped sine."""

from __future__ import annotations

import argparse
import shutil
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

from ..identification.outputs import ALL_PICTURES, OUTPUTS, REPORT, TABLES, require_room
from ..law.terms import KNOWN_TERMS
from ..project.files import json_text, replacing, write_text
from ..project.wording import listed, shortened
from ..records.quantities import with_error
from .options import coefficients, number, read_by, whole

EPILOG = """\
A record is one file per level of excitation: a channel that drives (base_displacement, base_acceleration or force) and
at least one of the mass (displacement, velocity, acceleration; relative_displacement, … where it was measured against
the base). Formats: CSV, TSV, Parquet, MATLAB, HDF5, universal file 58, TDMS, LabVIEW's text, WAV, NumPy,
JSON, spreadsheets. Where a file does not describe its channels, a small YAML file next to it does, NAME.yaml or
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

The exit status is 0 with an answer, 1 where the records give none (the cause is shown first), 2 for an error.
"""


_HELP = f"""\
records         one file per level, at least as many as coefficients; one is enough for a free decay
all records:
--kind          forced records, free decays, tables of a stepped sine, or measured loops (default: recognised)
--stiffness     k, N/m (of a rotation N m/rad), or 5.2±0.1, "29.7 lbf/in", "5.2 N/mm ± 1 %%"; it scales F_k and c
--mass          checks k, or gives it: kg (of a rotation kg m²), "6.8 lb", 2.42±0.01 (else 0.5 %%, half a digit)
--mapping       file or folder that names the channels of the records (default: the file next to each)
--write-mapping write a draft of a mapping to this file, with a reason for each channel, and do nothing else
forced records:
--frequency     known drive frequency, Hz, or "210 rpm"; compared with that of each record
--groups        a coefficient for each group of records: F_k=A,A,B, a label per record; may be repeated
--contact-to    base for a mount, whose spring, damper and friction all sit on the table (default: ground)
--fixture-mass  mass between a load cell and the vibrating mass, kg, or "0.4 lb"
--skip-cycles   cycles left out at the start of each record, where the motion has not settled (default: 0)
forced records or free decays:
--laws          compare laws of one or two terms, with and without friction, and name the one that the records support
forced records or tables of a stepped sine:
--terms         terms of the damping law, such as F_k,c,c_2 (default: F_k,c); known: {", ".join(KNOWN_TERMS)}
--given         a known coefficient, such as c=0.669, SI; may be repeated
tables of a stepped sine:
--contact       one slider, many that slip one after the other, or the one that the lines support (default: both)
--no-hardening  the spring does not stiffen with the amplitude
--residual      include other modes of the structure, which also move the driven point
measured loops:
--normal-force  normal force, N, or 5.0±0.1, for the friction coefficient
--fixture-stiffness  stiffness of a fixture in series whose deflection is also measured, N/m
--no-backlash   the fixture has no dead band
results:
--details       show all answers and all that limits them, instead of one screen
--output        write {", ".join(OUTPUTS)} there
--no-figures    write no pictures: they take longer than all the rest
--json          write {TABLES[0]} to this file as well; - shows it instead of the table
--report        write the report, one page of HTML with everything, to this file
--overwrite     replace existing results
"""

_SCREEN = Path("-")


def run(options: argparse.Namespace) -> bool:
    """Identify, show the table or the document, and write the results; or write a mapping.

    Returns whether there is an answer.
    """
    if options.write_mapping is not None:
        _write_mapping(options)
        return True
    from ..measured import OPTIONS, identify  # slow to import, not needed for help

    folder: Path | None = options.output
    document: Path | None = None if options.json == _SCREEN else options.json
    # before anything is computed
    permission = "" if options.overwrite else "--overwrite"
    if folder is not None:
        require_room(folder, (*TABLES, *ALL_PICTURES), permission)
    for file in filter(None, (document, options.report)):
        require_room(file.parent, [file.name], permission)
    stated = {name for each in OPTIONS.values() for name in each} & vars(options).keys()
    result = identify(kind=options.kind, **{name: getattr(options, name) for name in stated})
    answer = json_text(result.document())
    shown, width = answer, shutil.get_terminal_size().columns
    if options.json != _SCREEN:
        shown = result.text(width) if options.details else result.screen(width, details="--details")
    print(shown, end="")
    places, drawn = [], ""
    if document is not None:
        write_text(document, answer)
        places.append(str(document))
    if folder is not None:
        files = result.save(folder, figures=not options.no_figures, overwrite=options.overwrite)
        pictures = sum(file.suffix in (".svg", ".png") for file in files)
        names = [file.name for file in files if file.suffix not in (".svg", ".png")]
        names += [f"{pictures} pictures"] * bool(pictures)
        places.append(f"{folder}: {listed(names)}")
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
    from ..measured import recognised_as_table
    from ..records.mapping import find_mapping, read_mapping  # slow to import
    from ..records.readers import mapping_to_start_from, quantities_of

    file: Path = options.write_mapping
    if file.suffix != ".yaml":
        raise ValueError(f"--write-mapping {file}: the name of a mapping must end in .yaml")
    tables = options.kind == "recognised" and recognised_as_table(
        options.records[0], options.mapping
    )
    if tables or options.kind == "stepped-sine":
        raise ValueError(
            f"{options.records[0]} is a table of a stepped sine, and --write-mapping drafts mappings of signals only: "
            "write the mapping by hand, with the columns under `table`"
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


def _labels(text: str) -> dict[str, str]:
    """Parse an argument: a term and a label for each record, F_k=A,A,B."""
    name, equals, labels = text.partition("=")
    if not equals:
        raise argparse.ArgumentTypeError(
            f"must be TERM=LABELS with a label for each record, as in F_k=A,A,B, got {shortened(text)}"
        )
    return {name.strip(): labels}


def _checked(name: str, text: str) -> str:
    """Check that a text is a number, and return it as it stands, with its unit and its digits."""
    with_error(name, text)
    return text


class _Once(argparse.Action):
    """Collect options of one term or several each in one mapping; a term that is named twice is an error."""

    def __call__(
        self,
        parser: argparse.ArgumentParser,
        namespace: argparse.Namespace,
        values: Any,
        option_string: str | None = None,
    ) -> None:
        """Add the terms of one option."""
        collected = getattr(namespace, self.dest, {})
        if twice := collected.keys() & values.keys():
            remedy = "leave out one of the two"
            raise argparse.ArgumentError(self, f"{twice.pop()} is named twice: {remedy}")
        setattr(namespace, self.dest, collected | values)


_OPTIONS: dict[str, dict[str, Any]] = {
    "records": {"nargs": "+", "type": Path, "metavar": "RECORD"},
    "--kind": {
        "choices": ("forced", "ring-down", "stepped-sine", "loops"),
        "default": "recognised",
    },
    "--stiffness": {"type": read_by(_checked, "stiffness"), "metavar": "K"},
    "--mass": {"type": read_by(_checked, "mass"), "metavar": "M"},
    "--mapping": {"type": Path, "default": None, "metavar": "FILE"},
    "--write-mapping": {"type": Path, "default": None, "metavar": "FILE"},
    "--frequency": {"type": number("frequency"), "metavar": "HZ"},
    "--contact-to": {"choices": ("ground", "base")},
    "--fixture-mass": {"type": read_by(_checked, "fixture_mass"), "metavar": "M"},
    "--groups": {"type": _labels, "action": _Once, "metavar": "TERM=LABELS"},
    "--skip-cycles": {"type": whole("skip_cycles"), "metavar": "N"},
    "--laws": {"action": "store_true"},
    "--terms": {"metavar": "TERMS"},
    "--given": {"type": coefficients, "action": _Once, "metavar": "TERM=VALUE"},
    "--contact": {"choices": ("both", "one slider", "gradual")},
    "--no-hardening": {"action": "store_false", "dest": "hardening"},
    "--residual": {"action": "store_true"},
    "--normal-force": {"type": read_by(_checked, "normal_force"), "metavar": "N"},
    "--fixture-stiffness": {"type": number("fixture_stiffness"), "metavar": "K"},
    "--no-backlash": {"action": "store_false", "dest": "backlash"},
    "--details": {"action": "store_true", "default": False},
    "--output": {"type": Path, "default": None, "metavar": "DIR"},
    "--no-figures": {"action": "store_true", "default": False},
    "--json": {"type": Path, "default": None, "metavar": "FILE"},
    "--report": {"type": Path, "default": None, "metavar": "FILE"},
    "--overwrite": {"action": "store_true", "default": False},
}


def _arguments() -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield each argument of `_HELP`, with its group; an option that is not given leaves no trace.

    So the defaults are those of the functions that identify.
    """
    group = ""
    for line in _HELP.splitlines():
        if line.endswith(":"):
            group = line.removesuffix(":")
        else:
            name, words = line.split(maxsplit=1)
            defaults = {"default": argparse.SUPPRESS, "group": group, "help": words}
            yield name, defaults | _OPTIONS[name]


ARGUMENTS = dict(_arguments())
