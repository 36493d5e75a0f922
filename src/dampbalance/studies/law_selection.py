"""Records of a known damping law, and which law `identify` finds in them.

Each case is one experiment. An oscillator is drawn; its steady motion under its law is computed by `law/response.py`,
sampled with noise at every level and at two frequencies, one below the resonance and one above it, and identified like
measured records. Each term of the law takes a significant share of the work at one level at least, and the contact
slips once per half cycle at all of them. A case depends only on seed, law and run.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ..arrays import Array, Words
from ..features import stack
from ..identification.law_comparison import compare_laws
from ..law.response import law_orbit
from ..law.steady import Response, steady_response
from ..law.terms import FRICTION, KNOWN_TERMS
from ..likelihood.mean_harmonics import Reading, read_features
from ..model import BaseMotion, Oscillator
from ..motion.orbit import NoSteadyOrbit
from ..motion.regime import Regime
from ..project.progress import followed
from ..records.synthetic import measured_orbit
from .one_by_one import of_response
from .routes import NONE, law_named, terms_named
from .settings import Study

SHARE = (0.2, 0.6)
"""Smallest and largest share of the input work that each term takes at one level at least."""

MASSES, NATURAL_HZ = (0.1, 10.0), (1.0, 50.0)  # kg, Hz
HIGHEST = (1e-4, 1e-2)  # m, amplitude of the base at the highest level
ZETA = (0.01, 0.08)  # damping ratio of a viscous damper that takes as much work as all terms
STIFFNESSES = (10.0, 200.0)  # K_z/k
BELOW, ABOVE = (0.6, 0.9), (1.1, 1.6)  # ω/ω_n

_SAMPLES = (190.0, 210.0)  # per cycle
_MOST_DRAWINGS = 1000
_STICKS = 2.0  # in units of Z_m: the amplitude up to which the contact hardly slips


@dataclass(frozen=True)
class Truth:
    """The oscillator, law and base motions from which the records of a case are computed.

    oscillator : with its c.   law : symbol → coefficient of the terms other than friction and c, SI.   motions : of the
    base, one for each record.
    """

    oscillator: Oscillator
    law: Mapping[str, float]
    motions: tuple[BaseMotion, ...]

    def responses(self) -> list[Response] | None:
        """The steady responses; None unless each slips once per half cycle."""
        responses = []
        for motion in self.motions:
            try:
                response = steady_response(self.oscillator, motion, self.law)
            except NoSteadyOrbit:
                return None
            once = response.orbit.regime == Regime.ONE_SLIP
            if not (once and _STICKS * self.oscillator.Z_m < response.X):
                return None
            responses.append(response)
        return responses

    def shares(self, responses: Sequence[Response]) -> dict[str, Array]:
        """Share of the input work that each term takes, by symbol, each (records,); friction takes the rest."""
        k, law = self.oscillator.k, self.coefficients
        pairs = zip(responses, self.motions, strict=True)
        seen = stack([of_response(response, motion, k, self.law) for response, motion in pairs])
        integrals = {"c": seen.b, **seen.integrals}
        taken = {symbol: p * integrals[symbol] / seen.W for symbol, p in law.items()}
        return {FRICTION: 1.0 - np.sum(list(taken.values()), axis=0), **taken}

    @property
    def coefficients(self) -> dict[str, float]:
        """Coefficients of the terms other than friction, by symbol."""
        c = {"c": self.oscillator.c} if self.oscillator.c else {}
        return {**c, **self.law}


def drawn(law: str, levels: Sequence[float], random: np.random.Generator) -> Truth:
    """A random oscillator as described above.   law : its name.   levels : parts of the highest amplitude."""
    for _ in range(_MOST_DRAWINGS):
        truth = _candidate(terms_named(law), levels, random)
        if responses := truth.responses():
            shares = truth.shares(responses).values()
            if all(((part >= SHARE[0]) & (part <= SHARE[1])).any() for part in shares):
                return truth
    raise ArithmeticError(f"no oscillator with the law {law} slips once per half cycle as wanted")


def _candidate(terms: Sequence[str], levels: Sequence[float], random: np.random.Generator) -> Truth:
    """A random oscillator whose terms would share the work as wanted at one level if its motion were harmonic."""

    def spread(within: tuple[float, float]) -> float:
        return math.exp(random.uniform(math.log(within[0]), math.log(within[1])))

    m, omega_n = spread(MASSES), 2.0 * math.pi * spread(NATURAL_HZ)
    k = m * omega_n**2
    frequencies = [omega_n * random.uniform(*within) for within in (BELOW, ABOVE)]
    highest, zeta = spread(HIGHEST), spread(ZETA)
    omega = frequencies[int(random.integers(2))]
    Y = highest * sorted(levels)[len(levels) // 2]
    damper = 2.0 * zeta * math.sqrt(k * m)
    x = k * Y / complex(k - m * omega**2, damper * omega)
    X, phi = abs(x), -float(np.angle(x))
    work = math.pi * damper * omega * X**2
    friction, *others = _parts(len(terms), random)
    law = {}
    for symbol, share in zip(terms[1:], others, strict=True):
        of_one = float(KNOWN_TERMS[symbol].harmonic(omega, X, Y, phi, k))
        law[symbol] = float(share) * work / of_one
    return Truth(
        Oscillator(m, law.pop("c", 0.0), k, k * spread(STIFFNESSES), friction * work / (4.0 * X)),
        law,
        tuple(BaseMotion(highest * level, float(f)) for f in frequencies for level in levels),
    )


def _parts(count: int, random: np.random.Generator) -> Array:
    """Random shares of the work, each within SHARE, whose sum is one."""
    while True:
        parts = random.dirichlet(np.full(count, 4.0))
        if parts.min() >= SHARE[0] and parts.max() <= SHARE[1]:
            return parts


def chosen_law(
    law: str, levels: Sequence[float], cycles: int, noise: float, random: np.random.Generator
) -> str:
    """The law that `compare_laws` chooses for the records of an oscillator with `law`, by name; NONE where it rejects
    all, or cannot read the records."""
    truth = drawn(law, levels, random)
    readings: list[Reading] = []
    for motion in truth.motions:
        try:
            orbit = law_orbit(truth.oscillator, motion, truth.law)
            measurement = measured_orbit(
                orbit,
                rate_hz=random.uniform(*_SAMPLES) / motion.period,
                cycles=cycles,
                noise=noise,
                seed=random,
                start=random.random() * motion.period,
            )
            readings.append(read_features(measurement, truth.oscillator.k))
        except (ValueError, NoSteadyOrbit):
            return NONE
    chosen = compare_laws(readings, truth.oscillator.k).chosen
    return NONE if chosen is None else law_named(chosen)


def chosen_laws(study: Study, values: Mapping[str, Words]) -> Words:
    """The law that is chosen in each of n cases, (n,).   values : law, noise and, if runs are counted, run of each."""
    chosen = []
    runs = values.get("run", np.zeros(len(values["law"])))
    cases = zip(values["law"], values["noise"], runs, strict=True)
    for law, noise, run in followed(cases, len(runs), "cases"):
        random = np.random.default_rng([study.seed, *str(law).encode(), int(run)])
        chosen.append(chosen_law(str(law), study.levels, study.cycles, float(noise), random))
    return np.array(chosen, dtype=object)
