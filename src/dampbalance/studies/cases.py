"""The cases of a study: their values, their responses, the columns of their table, and how much all of it will be."""

from __future__ import annotations

import shutil
from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ..arrays import Array, Integers, Words
from ..features import Features
from ..law.terms import Term, term
from ..motion.regime import Regime
from ..project.documents import ConfigurationError
from .parameters import SI_COLUMNS, in_si, mechanical, of_law, parameter
from .study_file import CONTACT, Sampled, Study, case_values

PART = 131_072
"""Cases in memory at a time, 0.8 kB each, and in a row group of the file."""

MOST_CHUNKS = 20_000
"""Beyond this number of jobs the scheduler takes longer than the computations."""


class Cases(NamedTuple):
    """n cases that are computed together.

    numbers : in the study, (n,).
    values : of every parameter, by the names of PARAMETERS, each (n,).
    si : m, c, k, K_z, F_k, omega and coefficients of further terms by symbol, SI units, each (n,).
    Y : amplitudes of the base at L levels, m, (L, n).
    """

    study: Study
    numbers: Integers
    values: Mapping[str, Words]
    si: Mapping[str, Array]
    Y: Array


def cases_between(study: Study, start: int, stop: int) -> Cases:
    """Return the cases start … stop − 1 of a study."""
    fixed = {name: np.full(stop - start, value) for name, value in study.fixed.items()}
    values: dict[str, Words] = fixed | case_values(study.blocks, start, stop)
    si = in_si({name: values[name].astype(float) for name in mechanical(values)})
    Y = np.array(study.levels)[:, None] * (
        si["Y"] if study.levels_relative else np.ones(stop - start)
    )
    return Cases(study, np.arange(start, stop), values, si, Y)


class Responses(NamedTuple):
    """The responses of n cases at L levels.

    features : (L, n). The rest is for noisy records only.
    drawn : bootstrap replicates of the features, (L, n, r).
    simpson : features and replicates with a, b and W by `studies.simpson`, where a fit asks for them.
    likelihood : values and standard errors of the maximum-likelihood oscillator by symbol, SI units, (n,) each.
    """

    features: Features
    drawn: Features | None = None
    simpson: tuple[Features, ...] = ()
    likelihood: tuple[Mapping[str, Array], Mapping[str, Array]] = ({}, {})


NOT_READ = "not_read"
STEP_TOO_COARSE = "the fixed step is too coarse for the stick phases, or unstable"

REGIME_NAMES = {
    **{str(regime): regime.name.lower() for regime in Regime},
    STEP_TOO_COARSE: "step_too_coarse",
    "no slip onset could be read off the record": NOT_READ,
}
"""The regime of a response, or why a feature is missing: words → name in the table of cases. Other words give the
reason why a record could not be read."""


# --- the table ---------------------------------------------------------------------------------------


class Column(NamedTuple):
    """A column of the table of cases: name with unit, unit, meaning, and whether it holds words."""

    name: str
    unit: str
    meaning: str
    words: bool = False


_CONTACT_STIFFNESS = Term(CONTACT, None, "contact stiffness", "N/m")
"""Describes K_z, which is no term of a damping law, for the columns."""


def identified_by(symbol: str) -> Term:
    """Return the term of a damping law, or K_z, by its symbol."""
    return _CONTACT_STIFFNESS if symbol == CONTACT else term(symbol)


_STANDARD_ERROR = "standard error of {0.symbol} (bootstrap over cycles; of the fit, its covariance)"
_COVERED = "1 if the 95 % interval of {0.symbol} holds its true value, else 0"
_OF_TERMS = {
    "errors": [("{0.symbol}_relative_error", "1", "{0.symbol} identified / true − 1")],
    "estimates": [("{0.column}", "{0.unit}", "{0.symbol} identified")],
    "intervals": [
        ("{0.symbol}_relative_standard_error", "1", _STANDARD_ERROR + " / true {0.symbol}"),
        ("{0.symbol}_covered", "1", _COVERED),
    ],
}
"""Columns of a fit for each term, by the word that asks for them: name, unit and meaning, as formats of the term."""


def case_columns(study: Study) -> list[Column]:
    """Return the columns of the table of cases, in their order."""
    names, columns = study.axis_names, [Column("case", "1", "number of the case, counted from 0")]
    columns += map(_of_parameter, names)
    if "parameters" in study.columns:
        known = {*names} if study.levels_relative else {*names, "Y_m"}
        columns += [_of_parameter(name) for name in SI_COLUMNS.values() if name not in known]
        columns += map(_of_parameter, of_law(study.fixed))
    kinds = ", ".join(REGIME_NAMES.values())
    regimes = f"kind of response at each level, one word if all are alike: {kinds}"
    columns.append(Column("regime", "", regimes, words=True))
    true = {*SI_COLUMNS, *of_law(study.parameters).values()}
    for fit in study.fits:
        how = " ".join(part.replace("_", " ") for part in fit.parts)
        terms = [identified_by(symbol) for symbol in fit.identified]
        for kind in (kind for kind in _OF_TERMS if kind in study.columns):
            for identified in (t for t in terms if kind == "estimates" or t.symbol in true):
                for described in _OF_TERMS[kind]:
                    name, unit, meaning = (text.format(identified) for text in described)
                    columns.append(Column(f"{name}__{fit.label}", unit, f"{meaning}; {how}"))
        if "residuals" in study.columns:
            columns.append(Column(f"residual__{fit.label}", "1", f"‖A p − W‖/‖W‖; {how}"))
    return columns


def _of_parameter(name: str) -> Column:
    if name == SI_COLUMNS["omega"]:
        return Column(name, "rad/s", "drive frequency ω")
    p = parameter(name)
    return Column(name, p.unit, p.meaning, words=p.is_word)


# --- sizes -------------------------------------------------------------------------------------------


class StudySize(NamedTuple):
    """Size of a study: cases, levels of each, chunks, and bytes of the finished table; twice as many while the chunks
    are joined."""

    cases: int
    levels: int
    chunks: int
    table_bytes: int

    def __str__(self) -> str:
        most, while_joined = (size_in_words(times * self.table_bytes) for times in (1, 2))
        return (
            f"{self.cases:,} cases × {self.levels} levels = {self.cases * self.levels:,} responses, "
            f"{self.chunks:,} chunk{'s' if self.chunks > 1 else ''}, up to {most} (while it runs {while_joined})"
        )


def size_of(study: Study) -> StudySize:
    """Return the size of a study, whose bytes are an upper bound: constant columns and repeated words pack well.

    Eight bytes for every number that can differ from case to case, one or two for words and case numbers.
    """
    varied = sum(len(b.axes) for b in study.blocks if isinstance(b, Sampled))
    columns = [c for c in case_columns(study) if c.words or c.name not in study.axis_names]
    each = 8 * varied + 2 + sum(1 if c.words else 8 for c in columns)
    chunks = -(-study.cases // study.chunk_cases)
    return StudySize(study.cases, len(study.levels), chunks, 20_000 + study.cases * each)


def chunk_bounds(study: Study, chunk: int) -> tuple[int, int]:
    """Return the first case of a chunk and the one after its last."""
    start = chunk * study.chunk_cases
    return start, min(start + study.chunk_cases, study.cases)


def check_size(study: Study, size: StudySize, folder: str | Path, file: str | Path) -> None:
    """Raise ConfigurationError, with the number of cases and bytes, for a study that does not fit on the disk of
    `folder` or falls into too many chunks."""
    if size.chunks > MOST_CHUNKS:
        enough = -(-size.cases // MOST_CHUNKS)
        raise ConfigurationError(
            f"{file}: chunk_cases: {size.cases:,} cases in chunks of {study.chunk_cases:,} are {size.chunks:,} jobs; "
            f"take chunks of at least {enough:,} cases"
        )
    path = Path(folder).absolute()
    existing = next(place for place in (path, *path.parents) if place.exists())
    # 5 % of the free disk are left
    needed, free = 2 * size.table_bytes, int((1.0 - 0.05) * shutil.disk_usage(existing).free)
    if needed > free:
        raise ConfigurationError(
            f"{file}: axes: {size.cases:,} cases would take {size_in_words(needed)} of disk while they are computed, "
            f"and {size_in_words(free)} are free; take fewer cases or fewer columns"
        )


def size_in_words(count: float) -> str:
    """Return a number of bytes with a unit that suits it, e.g. 1.2 GB."""
    power = next((p for p in range(5) if count < 1000.0 ** (p + 1)), 5)
    return f"{count / 1000.0**power:.3g} {('bytes', 'kB', 'MB', 'GB', 'TB', 'PB')[power]}"
