"""From files to everything that an identification hands over, and to the files it is written to."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from .. import __version__
from ..balance import APPROACHES
from ..features import Phase
from ..likelihood.fit import reference_fit
from ..likelihood.information import NotIdentifiable
from ..likelihood.result import ReferenceFit
from ..project.files import write_csv, write_json, write_text
from ..record import Record
from ..records.mapping import MappingLike
from ..records.measurement import Measurement
from . import reporting
from .identify import REPLICATES, SEED, identify
from .loading import Loaded, load
from .result import Identification


@dataclass(frozen=True, eq=False)
class Results:
    """An identification, the records it comes from, and a maximum-likelihood fit of them where the mass was given."""

    records: tuple[Loaded, ...]
    found: Identification
    reference: ReferenceFit | None

    def text(self) -> str:
        """The table for a screen."""
        return reporting.text_table(self.found, self.reference)

    def document(self) -> dict[str, Any]:
        """Everything, for JSON."""
        return reporting.document(self.found, self.reference, __version__)


def identified(
    paths: Sequence[str | Path],
    k: float,
    *,
    mapping: MappingLike = None,
    frequency_hz: float | None = None,
    skip_cycles: int = 0,
    approaches: Sequence[str] | None = None,
    phase: Phase = "reversal",
    mass: float | None = None,
    replicates: int = REPLICATES,
    seed: int = SEED,
) -> Results:
    """F_k, c and K_z from record files, one per level.

    k : stiffness, N/m.   mapping, frequency_hz, skip_cycles : as for `load`.   approaches : names; default, all.
    phase : of the harmonic approaches.   mass : m, kg; if given, the maximum-likelihood fit is added.
    replicates, seed : of the bootstrap.

    Raises RecordError and ValueError naming the file, what is wrong, and the remedy.
    """
    unknown = sorted(set(approaches or ()) - set(APPROACHES))
    if unknown:
        raise ValueError(f"unknown approaches {unknown}; known are {', '.join(APPROACHES)}")
    named = [Path(path) for path in paths]
    doubled = sorted({str(path) for path in named if named.count(path) > 1})
    if doubled:
        raise ValueError(f"{doubled[0]} is named twice: each record is one level")
    chosen = {name: APPROACHES[name] for name in APPROACHES if not approaches or name in approaches}
    records = tuple(
        load(path, k, mapping=mapping, frequency_hz=frequency_hz, skip_cycles=skip_cycles)
        for path in named
    )
    found = identify(
        [one.reading for one in records],
        k,
        approaches=chosen,
        phase=phase,
        replicates=replicates,
        seed=seed,
    )
    reference = None
    if mass is not None:
        try:
            reference = maximum_likelihood(records, mass, k)
        except (ArithmeticError, NotIdentifiable) as error:  # the approaches stand without it
            said = f"no maximum-likelihood fit with m = {mass:g} kg: {error}"
            found = replace(found, warnings=(*found.warnings, said))
    return Results(records, found, reference)


def maximum_likelihood(records: Sequence[Loaded], m: float, k: float) -> ReferenceFit:
    """F_k, c and K_z of largest likelihood, the drive frequency of each record being fitted, too.

    Raises ValueError for records too large to be kept in memory, driven by an acceleration, or without a displacement
    of the mass.
    """
    return reference_fit(
        [_record(one, k) for one in records],
        [one.reading.steady.omega for one in records],
        m,
        k,
        free=("omega",),
    )


def write_results(results: Results, folder: str | Path) -> None:
    """Write OUTPUTS to a folder: each complete or not at all; the same bytes for the same records."""
    from ..figures.style import save  # slow to import, and needed for pictures only
    from . import drawing

    folder = Path(folder)
    document = results.document()
    write_csv(folder / "identification.csv", reporting.frame(results.found))
    write_csv(folder / "features.csv", reporting.features_frame(results.found))
    write_text(folder / "summary.txt", results.text())
    alt = drawing.alternative_texts(results.found)
    figures = {
        "cycles": drawing.cycles(results.records),
        "loops": drawing.loops(results.records, results.found),
        "balance": drawing.balance(results.found),
    }
    for name, figure in figures.items():
        save(figure, folder / f"{name}.svg", folder / f"{name}.png", alt[name])
    write_json(folder / "identification.json", document)


def _record(one: Loaded, k: float) -> Record:
    """The record without the cycles left out at its start."""
    if one.measurement is None:
        raise ValueError(
            f"{one.path} is too large for the maximum-likelihood fit: leave out the mass, or give shorter records"
        )
    measurement: Measurement = one.measurement
    for quantity in ("base_displacement", "force"):
        if quantity in measurement:
            base = measurement[quantity].values / (k if quantity == "force" else 1.0)
            t = measurement[quantity].t
            break
    else:
        raise ValueError(
            f"{one.path}: the maximum-likelihood fit needs base_displacement or force as input; leave out the mass"
        )
    if "displacement" not in measurement:
        raise ValueError(
            f"{one.path}: the maximum-likelihood fit needs the displacement of the mass; leave out the mass"
        )
    signals = {"t": t, "y": base}
    for name, quantity in (
        ("x", "displacement"),
        ("v", "velocity"),
        ("acceleration", "acceleration"),
    ):
        if quantity in measurement:
            if not np.array_equal(measurement[quantity].t, t):
                raise ValueError(
                    f"{one.path}: the maximum-likelihood fit needs all channels sampled at the same times; leave out "
                    "the mass"
                )
            signals[name] = measurement[quantity].values
    steady = one.reading.steady
    begin = int(np.searchsorted(t, steady.start - 0.5 * float(t[1] - t[0])))
    return Record(**{name: values[begin:] for name, values in signals.items()})
