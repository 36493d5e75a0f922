"""From files to everything that an identification hands over, and to the files it is written to."""

from __future__ import annotations

import math
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from .. import __version__
from ..balance import APPROACHES
from ..features import Phase
from ..law.law import law_of
from ..motion.jit import interpreted
from ..project.files import sha256, write_json, write_rows, write_text
from ..project.wording import visible
from ..records.limits import LARGEST
from ..records.mapping import MappingLike, mapping_file, mapping_for, parts_of
from . import reporting
from .identify import REPLICATES, SEED, identify
from .laws import compare_laws
from .loading import Loaded, load
from .outputs import FIGURES
from .result import Identification

_QUICK = 200_000  # calls of kernels, which take no more time in Python than Numba takes to load
_MOST_SWINGS = 1000.0  # of the free oscillator in a cycle of the drive, or cycles in a swing: beyond it a unit is wrong


@dataclass(frozen=True, eq=False)
class IdentificationRun:
    """An identification, and the records it comes from.

    options : what it was asked for, by the keys of a configuration.   files : digests of the files read for each
    record.
    """

    records: tuple[Loaded, ...]
    result: Identification
    options: Mapping[str, Any]
    files: tuple[Mapping[str, Any], ...]

    def text(self) -> str:
        """The table for a screen."""
        return reporting.text_table(self.result)

    def document(self) -> dict[str, Any]:
        """Everything, for JSON."""
        return reporting.document(self.result, __version__, self.options, self.files)


@interpreted(calls=_QUICK)  # whatever was compiled before: the last bits may differ
def identify_files(
    paths: Sequence[str | Path],
    k: float,
    *,
    mapping: MappingLike = None,
    frequency_hz: float | None = None,
    skip_cycles: int = 0,
    terms: Sequence[str] | None = None,
    given: Mapping[str, float] | None = None,
    groups: Mapping[str, Sequence[str]] | None = None,
    laws: bool = False,
    approaches: Sequence[str] | None = None,
    phase: Phase = "reversal",
    mass: float | None = None,
    replicates: int = REPLICATES,
    seed: int = SEED,
    largest: int = LARGEST,
) -> IdentificationRun:
    """The coefficients of a damping law and K_z from record files, one per level.

    k : stiffness, N/m.   mapping, frequency_hz, skip_cycles : as for `load`.   terms : of the law, symbols of
    `KNOWN_TERMS`; default, F_k, c and those that are given.   given : symbol → coefficient that is known, SI.
    groups : symbol → label for each record, in their order, of the group that has a coefficient of its own.
    laws : whether all laws of one or two terms beside friction are compared, too.   approaches : names; default, all.
    phase : of the harmonic approaches.   mass : m, kg, if it is known.
    replicates, seed : of the bootstrap.   largest : numbers (samples × channels) that may be read of a record.

    Raises RecordError and ValueError naming the file, what is wrong, and the remedy.
    """
    unknown = sorted(set(approaches or ()) - set(APPROACHES))
    if unknown:
        raise ValueError(f"unknown approaches {unknown}; known are {', '.join(APPROACHES)}")
    law = law_of(terms, given, groups)
    named = [Path(path) for path in paths]
    require_different(named)
    chosen = {name: APPROACHES[name] for name in APPROACHES if not approaches or name in approaches}
    records = tuple(
        load(
            path,
            k,
            mapping=mapping,
            frequency_hz=frequency_hz,
            skip_cycles=skip_cycles,
            largest=largest,
        )
        for path in named
    )
    _require_possible(records, mass, k)
    result = identify(
        [one.reading for one in records],
        k,
        law=law,
        approaches=chosen,
        phase=phase,
        mass=mass,
        replicates=replicates,
        seed=seed,
    )
    if laws:
        compared = compare_laws(
            [one.reading for one in records],
            k,
            law=law,
            mass=mass,
            replicates=replicates,
            seed=seed,
        )
        result = replace(result, laws=compared)
    options = {
        "stiffness_N_per_m": k,
        "frequency_hz": frequency_hz,
        "mass_kg": mass,
        "terms": list(law.terms),
        "given": dict(law.given),
        "groups": {symbol: list(labels) for symbol, labels in law.groups.items()},
        "laws": laws,
        "approaches": list(chosen),
        "phase": phase,
        "mapping": str(mapping) if isinstance(mapping, str | Path) else None,
        "skip_cycles": skip_cycles,
        "replicates": replicates,
        "seed": seed,
        "largest": largest,
    }
    files = tuple(digests(path, mapping) for path in named)
    return IdentificationRun(records, result, options, files)


def digests(path: Path, mapping: MappingLike) -> dict[str, Any]:
    """The SHA-256 digest of a record's file, of the file that names its channels, and of others that hold some."""
    file = mapping_file(path, mapping)
    others = [part for part in parts_of(path, mapping_for(path, mapping)) if part != path]
    more = [{"file": str(part), "sha256": sha256(part)} for part in others]
    return ({"others": more} if more else {}) | {
        "sha256": sha256(path),
        "mapping": None if file is None else {"file": str(file), "sha256": sha256(file)},
    }


def require_different(paths: Sequence[Path]) -> None:
    """ValueError for a file that is named twice, also by a link or another spelling of its path."""
    known: dict[tuple[int, int], Path] = {}
    for path in paths:
        try:
            found = path.stat()
        except (OSError, ValueError):  # reading it will say why
            continue
        other = known.setdefault((found.st_dev, found.st_ino), path)
        if other is not path:
            named = (
                f"{path} is named twice" if other == path else f"{path} and {other} are one file"
            )
            raise ValueError(f"{visible(named)}: each record is one level")


def _require_possible(records: Sequence[Loaded], mass: float | None, k: float) -> None:
    """ValueError for a mass with which the oscillator would be a thousand times faster or slower than the drive."""
    if mass is None:
        return
    for one in records:
        swings = math.sqrt(k / mass) / one.reading.steady.omega
        if not 1.0 / _MOST_SWINGS < swings < _MOST_SWINGS:
            raise ValueError(
                f"with k = {k:g} N/m and m = {mass:g} kg the oscillator swings {swings:.2g} times in a cycle of "
                f"{one.path}: give the mass in kg and the stiffness in N/m, or leave out the mass"
            )


def write_results(run: IdentificationRun, folder: str | Path) -> None:
    """Write OUTPUTS to a folder: each complete or not at all; the same bytes for the same records."""
    write_figures(run, folder)
    write_tables(run, folder)  # last, as pictures may fail


def write_tables(run: IdentificationRun, folder: str | Path) -> None:
    """Write TABLES to a folder, the document last."""
    folder = Path(folder)
    write_rows(folder / "identification.csv", reporting.estimates_table(run.result))
    write_rows(folder / "features.csv", reporting.features_table(run.result))
    write_text(folder / "summary.txt", run.text())
    write_json(folder / "identification.json", run.document())


@interpreted(calls=_QUICK)
def write_figures(run: IdentificationRun, folder: str | Path) -> None:
    """Write PICTURES to a folder."""
    from ..figures.style import save  # slow to import, and needed for pictures only
    from . import drawing

    alt = drawing.alternative_texts(run.result)
    figures = (
        drawing.cycles(run.records, run.result),
        drawing.loops(run.records, run.result),
        drawing.balance(run.result),
    )
    with warnings.catch_warnings():  # a name in a script that the font lacks shows as boxes
        warnings.filterwarnings("ignore", r"Glyph .* missing from font", UserWarning)
        for name, figure in zip(FIGURES, figures, strict=True):
            svg, png = (Path(folder, f"{name}.{suffix}") for suffix in ("svg", "png"))
            save(figure, svg, png, alt[name], drawing.DPI)
