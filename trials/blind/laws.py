"""Records of six damping laws by fixed steps, and which law `identify` finds in them: the confusion table.

A set has three amplitudes at two frequencies, one below and one above the resonance. Its oscillator is drawn so that
every term of its law takes 20 to 60 % of the work at one of the levels or more, and the contact slips at every level,
with one onset per half cycle. Neither forces nor motion come from the package: `other_motion.py` integrates them.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
import pandas as pd

from dampbalance.identification.law_comparison import compare_laws
from dampbalance.project.wording import markdown_table
from dampbalance.records.channel import Channel
from dampbalance.records.record import Record
from dampbalance.signals.mean_harmonics import read_features

from .other_motion import Departure, steady
from .score import share
from .truths import SEED, log_uniform

# terms besides friction, by the law's name
TERMS = (("c",), ("c_r",), ("c_2",), ("c_3",), ("eta",), ("c", "c_2"))
LAWS = {" + ".join(("F_k", *symbols)): symbols for symbols in TERMS}
AMPLITUDES = (0.25, 0.5, 1.0)  # of the base, in units of the highest
NOISE, CYCLES = 0.01, 100.0
SHARE = (0.2, 0.6)  # what each term takes of the work at one level or more
NONE = "none"  # where no law is chosen
_FIELDS = {"c_r": "relative", "c_2": "quadratic", "c_3": "third_power", "eta": "structural"}
_DENSE = 4096  # phases that stand for a cycle
_NOISE = 2  # so that the noise is not drawn from the generator that drew the set
_MOST_DRAWINGS = 1000

# x′, y′, k, ω → the force of a term over its coefficient
_FORCES: dict[str, Callable[..., np.ndarray]] = {
    "c": lambda v, w, k, omega: v,
    "c_r": lambda v, w, k, omega: v - w,
    "c_2": lambda v, w, k, omega: np.abs(v) * v,
    "c_3": lambda v, w, k, omega: v**3,
    "eta": lambda v, w, k, omega: k / omega * v,
}


@dataclass(frozen=True)
class Drawn:
    """One set. SI units.

    coefficients : of the terms besides friction.   levels : (Y, ω), m, rad/s.
    """

    law: str
    m: float
    k: float
    K_z: float
    F_k: float
    coefficients: Mapping[str, float]
    levels: tuple[tuple[float, float], ...]

    @cached_property
    def signals(self) -> list[np.ndarray]:
        """(x, x′) over a cycle from the peak of the base on, (2, n), at each level."""
        phase = _phases()
        return [motion(phase)[:2] for motion in self.motions]

    @cached_property
    def motions(self) -> list[Callable[[np.ndarray], np.ndarray]]:
        """(x, x′, x″) of ωt at each level."""
        p = self.coefficients
        how = Departure(**{_FIELDS[s]: value for s, value in p.items() if s in _FIELDS})
        c = p.get("c", 0.0)
        return [steady((self.m, c, self.k, self.K_z, self.F_k, *one), how) for one in self.levels]

    @property
    def slips_once(self) -> bool:
        """Whether there is one onset per half cycle at every level: two reversals, more than 2Z_m apart."""
        Z_m = self.F_k / self.K_z
        return all(
            np.ptp(x) > 4.0 * Z_m and np.count_nonzero(np.diff(np.sign(v[np.r_[:_DENSE, 0]]))) == 2
            for x, v in self.signals
        )

    def shares(self) -> dict[str, np.ndarray]:
        """Return what each term takes of the work put in, by level; friction takes the rest."""
        found = {}
        for symbol, p in self.coefficients.items():
            parts = []
            for (Y, omega), (_, v) in zip(self.levels, self.signals, strict=True):
                y, w = Y * np.cos(_phases()), -omega * Y * np.sin(_phases())
                lost = p * np.mean(_FORCES[symbol](v, w, self.k, omega) * v)
                parts.append(lost / np.mean(self.k * y * v))
            found[symbol] = np.array(parts)
        return {"F_k": 1.0 - sum(found.values()), **found}

    @property
    def wanted(self) -> bool:
        """Whether the set is one of those described above."""
        return self.slips_once and all(
            ((part >= SHARE[0]) & (part <= SHARE[1])).any() for part in self.shares().values()
        )


def _phases() -> np.ndarray:
    return np.arange(_DENSE) * (2.0 * math.pi / _DENSE)


@lru_cache(maxsize=4)  # its records need it again
def draw(law: str, drawing: int, seed: int = SEED) -> Drawn:
    """Set number `drawing` ≥ 0 of a law, of (seed, law, drawing) alone."""
    random = np.random.default_rng((seed, list(LAWS).index(law), drawing))
    for _ in range(_MOST_DRAWINGS):
        candidate = _candidate(law, random)
        if candidate.wanted:
            return candidate
    raise ArithmeticError(f"no set of {law} is as wanted")


def _candidate(law: str, random: np.random.Generator) -> Drawn:
    """Return an oscillator whose terms share the work as wanted at its middle amplitude, if its motion were
    harmonic."""
    spread = log_uniform(random)
    m, omega_n = spread(0.1, 10.0), 2.0 * math.pi * spread(1.0, 50.0)
    k = m * omega_n**2
    frequencies = omega_n * random.uniform(0.6, 0.9), omega_n * random.uniform(1.1, 1.6)
    highest, zeta = spread(1e-4, 1e-2), spread(0.01, 0.08)
    omega, Y = frequencies[int(random.integers(2))], AMPLITUDES[1] * highest
    damper = 2.0 * zeta * math.sqrt(k * m)
    x = k * Y / complex(k - m * omega**2, damper * omega)
    work = math.pi * damper * omega * abs(x) ** 2
    friction, *others = _shares(1 + len(LAWS[law]), random)
    v, w = (np.real(1j * omega * amplitude * np.exp(1j * _phases())) for amplitude in (x, Y))
    coefficients = {}
    for symbol, part in zip(LAWS[law], others, strict=True):
        lost = 2.0 * math.pi / omega * np.mean(_FORCES[symbol](v, w, k, omega) * v)
        coefficients[symbol] = float(part * work / lost)
    return Drawn(
        law=law,
        m=m,
        k=k,
        K_z=k * spread(10.0, 200.0),
        F_k=friction * work / (4.0 * abs(x)),
        coefficients=coefficients,
        levels=tuple((part * highest, float(f)) for f in frequencies for part in AMPLITUDES),
    )


def _shares(count: int, random: np.random.Generator) -> np.ndarray:
    """Return parts of the work, each within SHARE."""
    while True:
        parts = random.dirichlet(np.full(count, 4.0))
        if parts.min() >= SHARE[0] and parts.max() <= SHARE[1]:
            return parts


def law_records(law: str, drawing: int, seed: int = SEED) -> list[Record]:
    """Return the records of a set: base and mass displaced, 100 cycles of about 200 samples from anywhere in the cycle,
    1 % of white noise on both channels."""
    truth = draw(law, drawing, seed)
    random = np.random.default_rng((_NOISE, seed, list(LAWS).index(law), drawing))
    records = []
    for place, ((Y, omega), motion) in enumerate(zip(truth.levels, truth.motions, strict=True), 1):
        rate = random.uniform(190.0, 210.0) * omega / (2.0 * math.pi)
        t = np.arange(round(CYCLES * rate * 2.0 * math.pi / omega)) / rate
        phase = omega * t + random.uniform(0.0, 2.0 * math.pi)
        x = motion(np.mod(phase, 2.0 * math.pi))[0]
        clean = {"base_displacement": Y * np.cos(phase), "displacement": x}
        channels = [
            Channel(q, t, x + NOISE * np.sqrt(np.mean(x**2)) * random.standard_normal(x.size))
            for q, x in clean.items()
        ]
        records.append(Record.of(f"{law}, set {drawing}, level {place}", channels))
    return records


def outcome(run: tuple[str, int]) -> list[dict[str, object]]:
    """Return which law `compare_laws` chooses for the records of a set.   run : law and number of the set."""
    law, drawing = run
    measurements, k = law_records(law, drawing), draw(law, drawing).k
    began = time.process_time()
    try:
        readings = [read_features(measurement, k) for measurement in measurements]
        chosen = compare_laws(readings, k).chosen
        found = NONE if chosen is None else named(chosen)
    except (ValueError, ArithmeticError) as error:  # a refusal is an outcome, too
        found = f"refused: {error}"
    seconds = time.process_time() - began
    return [{"law": law, "set": drawing, "chosen": found, "seconds": seconds}]


def named(symbols: Iterable[str]) -> str:
    """Return the name of a law by its terms."""
    return " + ".join(["F_k", *(symbol for symbol in symbols if symbol != "F_k")])


def table(rows: pd.DataFrame) -> str:
    """Return true law × chosen law, in sets, with the parts that are right and that have a term too many, each with its
    own 95 % interval."""
    right = rows["chosen"] == rows["law"]
    pairs = zip(rows["law"], rows["chosen"], strict=True)
    extra = pd.Series([_terms(chosen) > _terms(law) for law, chosen in pairs], index=rows.index)
    counts = pd.crosstab(rows["law"], rows["chosen"])
    columns = [*LAWS, *sorted(set(counts.columns) - set(LAWS))]
    counts = counts.reindex(index=list(LAWS), columns=columns, fill_value=0)
    lines = []
    for law in LAWS:
        own = rows["law"] == law
        cells = [str(counts.loc[law, other] or "") for other in columns]
        lines.append([law, str(own.sum()), *cells, share(right[own]), share(extra[own])])
    heads = ["true law", "sets", *columns, "right, %", "a term too many, %"]
    none = share(rows["chosen"] == NONE)
    return (
        f"{markdown_table(heads, lines)}\n\nOf all sets, %: the right law in {share(right)}, a term too many in "
        f"{share(extra)}, no law in {none}.\n"
    )


def _terms(law: str) -> frozenset[str]:
    """Return the terms of a law by its name; none for words."""
    return frozenset(law.split(" + ")) if law.startswith("F_k") else frozenset()
