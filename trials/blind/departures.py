"""Forced records of oscillators that are not of the model, or measured with a fault: is what comes out wrong, and is
that said?

A set is one of `truths.py`, with 0.1 to 3 % of noise, and one departure; "none" are sets without one, for false alarms.
A set is silent where a number is called usable and is more than five standard errors off, and no sentence says that K_z
may be off by as much because the contact may yield gradually.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import pandas as pd
from scipy.interpolate import CubicSpline

from dampbalance.findings.finding import within
from dampbalance.identification.answer import USABLE
from dampbalance.identification.forced import identify_readings
from dampbalance.identification.screen import limiting
from dampbalance.project.wording import markdown_table
from dampbalance.signals.mean_harmonics import read_features

from .gradual import CONTACTS, steady_on
from .other_motion import NO_DEPARTURE, Departure, in_units, numbers_of, steady
from .records import Level, record
from .score import SYMBOLS, in_errors
from .truths import ANSWERS, SEED, Truth, draw, log_uniform

FAR = 5.0  # standard errors
NONE = "none"
_NOISE = (0.001, 0.03)
_DAMPED = 0.05  # of the critical damping: of less, a steady motion takes long to integrate
_CYCLES, _SAMPLES = 100.0, 149.63  # most cycles of a record, and samples of a cycle: more cost time
_SET = 5  # so that the noise is not drawn from the generator that drew the set
_POINTS = 8192  # of a cycle

Motion = Callable[[Truth, int], CubicSpline]
"""(x, x′, x″) of the steady period of a level as a periodic function of ωt, SI."""


def on(name: str) -> Motion:
    """Return a contact of `gradual.CONTACTS`."""
    contact = CONTACTS[name]
    return lambda t, i: steady_on(contact(t.K_z, t.F_k), t.m, t.c, t.k, t.Y[i], t.omega)


def departed(departure: Departure) -> Motion:
    """Return a departure in the units of `in_units`."""
    return lambda t, level: steady(numbers_of(t, level), in_units(departure, t))


def _unequal(t: Truth, level: int) -> CubicSpline:
    own = replace(t, F_k=t.F_k * np.linspace(0.9, 1.1, len(t.Y))[level])
    return steady(numbers_of(own, level), NO_DEPARTURE)


@dataclass(frozen=True)
class Departing:
    """A departure.

    motion : of the mass; None for that of the model.   third : harmonic 3 of the drive, over the first.   late : phase
    by which the answers lag, rad.   corner : of a high-pass filter of the answers, over the frequency.   gain : of the
    answers.   k : as given, over the true one.
    """

    motion: Motion | None = None
    third: float = 0.0
    late: float = 0.0
    corner: float = 0.0
    gain: float = 1.0
    k: float = 1.0


DEPARTURES = {
    NONE: Departing(),
    **{f"contact: {name}": Departing(on(name)) for name in CONTACTS},
    "friction 20 % higher at rest": Departing(departed(Departure(falling=0.2, speed=0.1))),
    "quadratic damping, 30 % of c": Departing(departed(Departure(quadratic=0.3))),
    "even stiffness, 2 % of k": Departing(departed(Departure(even=0.02))),
    "cubic stiffness, 2 % of k": Departing(departed(Departure(cubic=0.02))),
    "third harmonic of 1 % in the base": Departing(departed(Departure(third=0.01)), third=0.01),
    "response late by 2°": Departing(late=math.radians(2.0)),
    "response AC-coupled at 5 % of the frequency": Departing(corner=0.05),
    "F_k 0.9 to 1.1 times, by level": Departing(_unequal),
    "gain of the response +2 %": Departing(gain=1.02),
    "k 2 % too high": Departing(k=1.02),
}
"""By name; gain and k leave no trace in a record: nobody can say them."""


@dataclass(frozen=True, eq=False)
class Departed(Level):
    """A level whose record departs."""

    how: Departing

    @cached_property
    def motion(self) -> CubicSpline:
        """(x, x′, x″) as measured, a periodic function of ωt."""
        if self.how.motion is not None:
            return self.how.motion(self.truth, self.level)
        phases = np.linspace(0.0, 2.0 * math.pi, _POINTS + 1)
        exact = [super(Departed, self).signal(quantity, phases[:-1]) for quantity in ANSWERS]
        harmonics = np.fft.rfft(exact)
        n = np.arange(harmonics.shape[1]) + 1e-9
        cycle = np.fft.irfft(harmonics * n / (n - 1j * self.how.corner), _POINTS)
        whole = np.column_stack([cycle, cycle[:, :1]])
        return CubicSpline(phases, whole, axis=1, bc_type="periodic")

    def signal(self, quantity: str, phase: np.ndarray) -> np.ndarray:
        """Return a channel without noise at phases ωt, SI."""
        if quantity in ANSWERS:
            at = np.mod(phase - self.how.late, 2.0 * math.pi)
            return self.how.gain * self.motion(at)[ANSWERS.index(quantity)]
        drive = super().signal(quantity, phase)
        if self.how.third:
            part = self.how.third * (9.0 if quantity == "base_acceleration" else 1.0)
            drive = drive + part * super().signal(quantity, 3.0 * phase)
        return drive


def drawn(index: int, seed: int = SEED) -> Truth:
    """Set number `index`: one of `truths.py` whose contact slips at all levels, and whose motion is soon steady."""
    random = np.random.default_rng((_SET, seed, index))
    while True:
        truth = draw(int(random.integers(2**31)), seed)
        sound = truth.kind == "model" and truth.zeta > _DAMPED
        if sound and all(Level(truth, i).cycle.slips for i in range(len(truth.Y))):
            return replace(
                truth,
                index=index,
                noise=log_uniform(random)(*_NOISE),
                cycles=tuple(min(cycles, _CYCLES) for cycles in truth.cycles),
                rate_hz=min(truth.rate_hz, _SAMPLES * truth.omega / (2.0 * math.pi)),
            )


def outcome(run: tuple[str, int, int]) -> list[dict[str, object]]:
    """Return a row for a set.   run : name of the departure, number, seed."""
    name, index, seed = run
    truth, how = drawn(index, seed), DEPARTURES[name]
    row: dict[str, object] = {"departure": name, "set": index, "noise": truth.noise}
    row |= {"levels": len(truth.Y), "K": truth.K_z / truth.k, "zeta": truth.zeta}
    row |= {"F": truth.F_k / (truth.k * truth.Y[-1]), "r": truth.omega / truth.omega_n}
    k = how.k * truth.k
    measured = [record(Departed(truth, i, how), (_SET, seed)) for i in range(len(truth.Y))]
    began = time.process_time()
    try:
        readings = [read_features(one, k) for one in measured]
        result = identify_readings(readings, k)
    except (ValueError, ArithmeticError) as error:
        return [row | {"refused": str(error)}]
    row["seconds"] = time.process_time() - began
    answer = result.answer
    row["words"] = " | ".join(limiting(result))
    inner = [one for of in result.findings for one in within(of.numbers.values())]
    row["gradual"] = any(one.code == "gradual" for one in inner)
    for symbol in SYMBOLS:
        p, true = answer.parameters[symbol], truth.parameter(symbol)
        sizes = abs(in_errors(symbol, p.value, true, p.standard_error or math.nan))
        row |= {f"{symbol}_off": p.value / true - 1.0, f"{symbol}_sizes": sizes}
        row[f"{symbol}_usable"] = answer.verdicts[symbol].verdict == USABLE
    return [row]


def table(rows: pd.DataFrame) -> str:
    """Return a table by departure, in sets: what is doubted, what is wrong, and what is wrong without a word."""
    lines = []
    for name, some in rows.groupby("departure", sort=False):
        known = some[some["F_k_usable"].notna()]
        usable = {s: known[f"{s}_usable"].astype(bool) for s in SYMBOLS}
        wrong = {s: known[f"{s}_sizes"] > FAR for s in SYMBOLS}
        silent = {s: wrong[s] & usable[s] for s in SYMBOLS}
        of_any = silent["F_k"] | silent["c"] | silent["K_z"]
        off = 100.0 * known.loc[usable["K_z"], "K_z_off"].abs().median()
        cells = [len(some), len(some) - len(known), known["gradual"].astype(bool).sum()]
        cells += [usable[s].sum() for s in SYMBOLS]
        cells += [pd.DataFrame(wrong).any(axis=1).sum(), *(silent[s].sum() for s in SYMBOLS)]
        cells += [of_any.sum(), f"{off:.2g}"]
        lines.append([str(name), *map(str, cells)])
    heads = ["departure", "sets", "refused", "gradual contact named", "F_k usable", "c", "K_z"]
    heads += ["beyond 5 standard errors", "of it usable: F_k", "c", "K_z"]
    heads += ["silent", "K_z usable, off by, % (median)"]
    return markdown_table(heads, lines) + "\n"
