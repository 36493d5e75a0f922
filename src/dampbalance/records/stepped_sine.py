"""Tables of steady responses to a stepped sine: frequency, amplitudes of force or base and of the response, phase.

A line is the steady response at one frequency and one level of excitation. Laboratories count the phase in many ways:
as a lead or a lag, of the response or the drive, of displacement, velocity or acceleration. The convention follows from
the lines themselves. If the displacement lags the force F by φ, the work of the force per cycle, W = πFX sin φ, is
positive in every line; of the conventions for which this holds, the one with the closest fit of an oscillator to each
level is taken, (F/X) e^{iφ} = k − mω² + i(ωc + h) with k, m, c and h ≥ 0.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Array, Integers, ReadOnly
from ..project.wording import listed, shortened, visible
from .channel import ABSOLUTE, Channel
from .draft import unclear
from .errors import RecordError
from .guess import Guesses
from .headings import STANDARD_ERROR, column_of, is_stepped_sine, last_part, unit_of, words_of
from .mapping import ChannelRule, RecordMapping
from .record import Record
from .table import Table
from .units import (
    PER_FORCE,
    TABLE_DIMENSIONS,
    TABLE_DRIVES,
    TABLE_RESPONSES,
    UnitError,
    reference_of,
    table_factor,
)

if TYPE_CHECKING:
    import pandas as pd

_ORDERS = {"force": 0, "length": 0, "velocity": 1, "acceleration": 2}
_FEWEST_LINES = 3  # of a level

_EMPTY = "is empty or not a number; repair it, or delete the line"
_POSITIVE = (
    "is not positive, as everything except a phase must be; check the column, or delete the line"
)
_RISING = (
    "turns back or stands, but the frequencies of a level must rise or fall; name a column of levels, or delete the "
    "line"
)
_MIXED = "follows another convention than most lines (the drive would extract energy): correct it, or delete the line"
_COHERENT = "is no coherence, which lies above 0 and does not exceed 1; check the column, or delete the line"

Place = tuple[str, int]  # group and number of a level in a file


@dataclass(frozen=True, eq=False)
class SteppedLevel:
    """The lines of one level of excitation, (n,), in SI units.

    name : of the level.
    omega : rad/s.
    drive : amplitude of the force, N, or of the base displacement, m.
    X : amplitude of the displacement, m.
    phi : phase by which it lags the drive, rad, 0 to π.
    error : relative standard error of F/X and standard error of phi, rad; None if the table states none.
    rows : rows of the file, counted from 0.
    """

    name: str
    omega: Array
    drive: Array
    X: Array
    phi: Array
    error: Array | None
    rows: Integers


@dataclass(frozen=True, eq=False, repr=False)
class SteppedRecord(Record):
    """A table of steady responses to a stepped sine as a record of `read_records`; it has lines instead of samples.

    levels : of excitation.   held : the quantities of its drive and its response.   convention : how its phases are
    counted, in words.
    """

    channels: Mapping[str, Channel] = field(default_factory=lambda: ReadOnly({}))
    levels: tuple[SteppedLevel, ...] = field(kw_only=True)
    held: tuple[str, str] = field(kw_only=True)
    convention: str = field(kw_only=True)

    def __post_init__(self) -> None:
        """Require no channels."""

    @property
    def quantities(self) -> tuple[str, ...]:
        """The quantities of its drive and its response."""
        return self.held

    @property
    def by_force(self) -> bool:
        """Whether a force drives, and not the base."""
        return self.held[0] == "force"

    def to_frame(self) -> pd.DataFrame:
        """Return the lines as a table: level, frequency_Hz, force_N or base_displacement_m, displacement_m, and the
        phase_rad by which the displacement lags."""
        import pandas as pd  # slow to import

        columns = [(of.omega / (2.0 * math.pi), of.drive, of.X, of.phi) for of in self.levels]
        drive = "force_N" if self.by_force else "base_displacement_m"
        names = ["frequency_Hz", drive, "displacement_m", "phase_rad"]
        frame = pd.DataFrame(np.hstack(columns).T, columns=names)
        sizes = [of.X.size for of in self.levels]
        frame.insert(0, "level", np.repeat([of.name for of in self.levels], sizes))
        return frame

    def corrected(self) -> Record:
        """Raise RecordError: it has no channels."""
        raise RecordError(
            f"{self.name} is a table of steady responses, without samples; use its lines, `levels`"
        )

    def __repr__(self) -> str:
        """Summarize the table in a line."""
        sizes = [of.X.size for of in self.levels]
        levels = f"{sum(sizes)} lines at {len(sizes)} level{'s' * (len(sizes) > 1)}"
        return f"<table {self.name}: {levels}; {self.convention}>"


def read_lines(
    file: Table, rules: RecordMapping, label: str, stated: bool = False
) -> SteppedRecord | None:
    """Return the record, in SI units, in an open file that is a table of steady responses; None for any other file.

    rules : what the file does not say.   label : of a level without a name.   stated : whether it is known to be a
    table; otherwise its columns decide.

    Raises RecordError naming file, column or line, and the remedy: a column that is missing or unclear, a unit that is
    missing or wrong, a missing value, an amplitude that is not positive, frequencies of a level that turn back or
    stand, a constant column, phases in another unit than stated, lines with phases of another convention.
    """
    if not (stated or is_stepped_sine(file, rules)):
        return None
    return _Table(file, rules).read(visible(rules.level or label))


class _Table:
    """The columns of a file by mapping or headings: quantity → place of the level → column."""

    def __init__(self, file: Table, rules: RecordMapping) -> None:
        self.file, self.rules = file, rules
        self.guesses = Guesses(file, rules, stepped=True)
        self.columns: dict[str, dict[Place, int]] = {}
        recognised = ((role, i) for i, raw in enumerate(file.channels) if (role := column_of(raw)))
        for role, i in self._named() if rules.table else recognised:
            place = _place(file.channels[i].name)
            other = self.columns.setdefault(role, {}).setdefault(place, i)
            if other != i:
                both = listed([self.guesses.names[at] for at in (other, i)])
                raise unclear(self.guesses, f"{both} are both taken for {role}")
        for role in [q for q in self.columns if q.removesuffix(STANDARD_ERROR) not in self.columns]:
            del self.columns[role]
        answers = [q for q in TABLE_RESPONSES if q in self.columns]
        per_force = bool({*answers} & {*PER_FORCE})
        drives = [q for q in [*TABLE_DRIVES][: 1 if per_force else None] if q in self.columns]
        drives = drives or [""] * bool(per_force and rules.force_N)
        drive = "the force (or force_N, of all lines)" if per_force else "a force or the base"
        needed = {q: [q] * (q in self.columns) for q in ("frequency", "phase")}
        needed |= {drive: drives, f"a response ({', '.join(TABLE_RESPONSES)})": answers}
        wrong = [f"{listed(of) or 'nothing'} for {q}" for q, of in needed.items() if len(of) != 1]
        if wrong:
            each = " of each" * (len(wrong) > 1)
            raise unclear(self.guesses, f"finds {listed(wrong)}, and needs one{each}")
        self.drive, self.answer = drives[0], answers[0]
        self.decibels: set[str] = set()
        units = (q for q in self.columns if TABLE_DIMENSIONS[q.removesuffix(STANDARD_ERROR)])
        self.factors = {q: self._factor(q) for q in units}

    def _error(self, words: str, row: int | None = None) -> RecordError:
        """Return an error that names the file, and a row of it."""
        line = "" if row is None else f"{self.file.place(row)}: "
        return RecordError(f"{self.file.path}: {line}{words}")

    def _named(self) -> Iterator[tuple[str, int]]:
        """Yield the quantities of the mapping with their columns, of one name in several groups or of a matrix."""
        for quantity, rule in self.rules.table.items():
            yield from (
                (quantity, i) for i in self.guesses.find(rule.channel, f"table.{quantity}.channel")
            )
            if rule.standard_error is not None:
                found = self.guesses.find(rule.standard_error, f"table.{quantity}.standard_error")
                yield from ((quantity + STANDARD_ERROR, i) for i in found)

    def _factor(self, role: str) -> float:
        """Return the size in SI of the unit of a column; for a standard error, that of its quantity."""
        quantity = role.removesuffix(STANDARD_ERROR)
        rule = self.rules.table.get(quantity, ChannelRule(1))
        raw = self.file.channels[next(iter(self.columns[quantity].values()))]
        text = rule.unit or unit_of(raw, table=True)
        try:
            if text is None:
                raise UnitError(
                    f"has no unit: state it at table.{quantity}.unit in {self.guesses.where}"
                )
            factor = (rule.scale or 1.0) * table_factor(text, quantity)
            self.decibels |= {role} if reference_of(text) else set()
        except UnitError as error:
            words = f"column {shortened(raw.name)}: {error}"
            if not self.rules.table:
                raise unclear(self.guesses, words) from None
            raise self._error(words) from None
        if quantity == "frequency":
            return 2.0 * math.pi * factor
        return math.sqrt(2.0) * factor if "rms" in words_of(raw.name) else factor

    def read(self, label: str) -> SteppedRecord:
        """Return the record, with the phase φ by which the displacement lags in each line."""
        levels = [*self._levels(label)]
        phases = np.concatenate([level.phi for level in levels])
        low, high, radians = float(phases.min()), float(phases.max()), self.factors["phase"] == 1.0
        # phases beyond two turns are in degrees; phases within 0.1 rad pass through no resonance and are in rad
        many, few = max(-low, high) > 4.0 * math.pi, math.radians(1.0) < high - low < 0.1
        if many if radians else few:
            unit = "rad" if few else "deg"
            raise self._error(
                f"phases from {low:.3g} to {high:.3g} rad do not occur in tables: they are in {unit}; state it at "
                f"table.phase.unit in {self.guesses.where}"
            )
        by_force = self.drive in ("", "force")
        quarters, sign, phis = self._convention(levels, 3 if by_force else 4)
        against = "force" if by_force else "base velocity" if quarters == 3 else "base displacement"
        moved = (*ABSOLUTE, "displacement")[quarters]
        way = f"the {moved} {'leads' if sign > 0 else 'lags'} the {against}"
        return SteppedRecord(
            str(self.file.path),
            label=label,
            rules=self.rules,
            levels=tuple(replace(of, phi=phi) for of, phi in zip(levels, phis, strict=True)),
            held=(self.drive or "force", self.answer),
            convention=f"its phases are those by which {way}",
        )

    def _levels(self, label: str) -> Iterator[SteppedLevel]:
        """Yield the levels, with phases as recorded, rad: one for each group, column of a matrix, or value in the
        column of levels."""
        wanted = sorted({i for of in self.columns.values() for i in of.values()})
        values = self.file.columns(wanted)
        several = {q: of for q, of in self.columns.items() if len(of) > 1}
        places = list(next(iter(several.values()), {("", 0): 0}))
        for place in places:
            lacking = [q for q, of in several.items() if place not in of or len(of) != len(places)]
            if lacking:
                both = listed([*lacking, next(iter(several))])
                raise self._error(f"{both} are not in the same groups; give them for each level")
            own = {q: of.get(place, next(iter(of.values()))) for q, of in self.columns.items()}
            if len({values[i].size for i in own.values()}) > 1:
                sizes = [f"{q} has {values[i].size} values" for q, i in own.items()]
                raise self._error(f"{listed(sizes)}; columns of one level have equal lengths")
            columns = {q: values[i] for q, i in own.items()}
            rows = np.flatnonzero(~np.isnan([*columns.values()]).all(axis=0))
            levels = columns.get("level", np.zeros(rows.max(initial=0) + 1))
            for value in dict.fromkeys(levels[rows].tolist()):
                name = _called(place) if several else label
                name = f"level {value:g}" if "level" in columns else name
                those = rows[levels[rows] == value] if value == value else rows
                yield self._level(name, own, columns, those)

    def _level(
        self, name: str, own: Mapping[str, int], columns: Mapping[str, Array], rows: Integers
    ) -> SteppedLevel:
        """Return the lines of a level, checked, with phases as recorded, rad."""
        si = {q: columns[q][rows] * factor for q, factor in self.factors.items()}
        for q in self.decibels:
            level = 10.0 ** (columns[q.removesuffix(STANDARD_ERROR)][rows] / 20.0) * self.factors[q]
            decibels = math.log(10.0) / 20.0 * columns[q][rows]
            si[q] = decibels * level if q.endswith(STANDARD_ERROR) else level
        omega = si["frequency"]
        rising = np.append(True, np.diff(omega) * np.sign(omega[-1] - omega[0] or 1.0) > 0.0)
        checks = [(q, np.isfinite(columns[q][rows]), _EMPTY) for q in own]
        checks += [(q, of > 0.0, _POSITIVE) for q, of in si.items() if q != "phase"]
        checks.append(("frequency", rising, _RISING))
        if "coherence" in columns:
            coherence = columns["coherence"][rows]
            checks.append(("coherence", (coherence > 0.0) & (coherence <= 1.0), _COHERENT))
        for q, holds, words in checks:
            if not holds.all():
                row = int(rows[np.argmin(holds)])
                column = shortened(self.file.channels[own[q]].name)
                raise self._error(f"column {column}, {columns[q][row]:.6g}, {words}", row)
        if rows.size < _FEWEST_LINES:
            raise self._error(
                f"{name} has {rows.size} lines; a level needs at least {_FEWEST_LINES}"
            )
        drive = si.get(self.drive, np.full(rows.size, self.rules.force_N or 1.0))
        answer = si[self.answer] * (drive if self.answer in PER_FORCE else 1.0)
        for of, words in (
            (np.diff(si["phase"]), "phase is"),
            (np.diff([drive, answer]), "amplitudes are"),
        ):
            if not of.any():
                raise self._error(f"{name}: its {words} the same in all lines; check the column")
        orders = [_ORDERS[TABLE_DIMENSIONS[q or "force"]] for q in (self.drive, self.answer)]
        Y, X = drive / omega ** orders[0], answer / omega ** orders[1]
        if X.max() > 1.0:  # m
            at = int(rows[np.argmax(X)])
            raise self._error(
                f"a displacement of {X.max():.3g} m is too large: is the unit of {self.answer} wrong?",
                at,
            )
        squares = [
            (si[q + STANDARD_ERROR] / si[q]) ** 2
            for q in (self.drive, self.answer)
            if q + STANDARD_ERROR in si
        ]
        both = [np.sum(squares, axis=0)] if squares else []
        both += [si[q] ** 2 for q in si if q == "phase" + STANDARD_ERROR]
        if "coherence" in columns:
            # 1e12 averages if the number is unknown: the coherence gives the weights, the scatter their size
            averages = columns["averages"][rows] if "averages" in columns else 1e12
            # a coherence is known to 1e-6 at best
            noise = np.maximum(1.0 - coherence, 1e-6) / (2.0 * coherence * averages)
            both.append(noise)
        error = np.sqrt(np.mean(both, axis=0)) if both else None
        return SteppedLevel(name, omega, Y, X, si["phase"], error, rows)

    def _convention(
        self, levels: Sequence[SteppedLevel], most: int
    ) -> tuple[int, int, list[Array]]:
        """Return the convention of the phases p, n < `most` and s = ±1 in φ = n π/2 − s p, and φ of each level.

        Raises RecordError naming the first line that follows another convention, and if two conventions fit.
        """
        ways = {
            (n, s): [np.angle(np.exp(1j * (0.5 * math.pi * n - s * of.phi))) for of in levels]
            for n in range(most)
            for s in (1, -1)
        }
        shares = {way: float(np.mean(np.concatenate(phis) > 0.0)) for way, phis in ways.items()}
        best = max(shares.values())
        misfits = {
            way: _off_oscillators(levels, phis) for way, phis in ways.items() if shares[way] == best
        }
        (n, s), *others = sorted(misfits, key=misfits.__getitem__)
        for of, phi in zip(levels, ways[n, s], strict=True):
            if phi.min() <= 0.0:
                at = int(np.argmax(phi <= 0.0))
                raise self._error(f"the phase {of.phi[at]:.4g} rad {_MIXED}", int(of.rows[at]))
        # the second best convention must be 1.5 times as far from an oscillator
        if others and misfits[others[0]] < 1.5 * misfits[n, s]:
            raise self._error(
                "its phases may be leads or lags; give lines on both sides of a resonance"
            )
        return n, s, ways[n, s]


def _off_oscillators(levels: Sequence[SteppedLevel], phis: Sequence[Array]) -> float:
    """Return the distance of the levels from oscillators, Σ |1 − (k − mω² + i(ωc + h))/Z|² with Z = (F/X) e^{iφ}."""
    from scipy.optimize import nnls  # slow to import

    total = 0.0
    for of, phi in zip(levels, phis, strict=True):
        w, inverse = of.omega / of.omega.max(), of.X / of.drive
        columns = np.array([np.ones(w.size), -(w**2), 1j * w, 1j * np.ones(w.size)]).T
        columns = columns * (inverse / inverse.max() * np.exp(-1j * phi))[:, None]
        ones = np.append(np.ones(w.size), np.zeros(w.size))
        total += float(nnls(np.vstack([columns.real, columns.imag]), ones, maxiter=1000)[1]) ** 2
    return total


def _place(name: str) -> Place:
    """Return group and number of a column: "a.b.force[2]" is the second force in a.b."""
    last = last_part(name)
    number = re.search(r"\[(\d+)\]$", last)
    return name.removesuffix(last).rstrip("/."), int(number[1]) if number else 0


def _called(place: Place) -> str:
    """Return the name of a level by its group and number."""
    group, number = place
    return " ".join(filter(None, [re.split("[/.]", group)[-1] or "level", str(number or "")]))
