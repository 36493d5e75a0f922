"""Cases and their responses, the names of regimes, and the exact steady responses of n cases at L levels."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from ..arrays import Array, Integers, Words
from ..features import Features, of_orbits
from ..motion.orbits import steady_orbits
from ..motion.regime import Regime
from .settings import Study


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


class Responses(NamedTuple):
    """The responses of n cases at L levels.

    features : (L, n). The rest is for noisy records only.
    chosen : names of the laws that the records support, (n,), where a study asks for them instead of coefficients.
    drawn : bootstrap replicates of the features, (L, n, r).
    simpson : features and replicates with a, b and W by `reading.simpson`, where a fit asks for them.
    likelihood : values and standard errors of the maximum-likelihood oscillator by symbol, SI units, (n,) each.
    """

    features: Features
    drawn: Features | None = None
    simpson: tuple[Features, ...] = ()
    likelihood: tuple[Mapping[str, Array], Mapping[str, Array]] = ({}, {})
    chosen: Words | None = None


NOT_READ = "not_read"
STEP_TOO_COARSE = "the fixed step is too coarse for the stick phases, or unstable"

REGIME_NAMES = {
    **{str(regime): regime.name.lower() for regime in Regime},
    STEP_TOO_COARSE: "step_too_coarse",
    "no slip onset could be read off the record": NOT_READ,
}
"""The regime of a response, or why a feature is missing: words → name in the table of cases. Other words give the
reason why a record could not be read."""


def exact_responses(cases: Cases, threads: int | None = None) -> Features:
    """The exact steady responses of n cases at L levels, as features of shape (L, n)."""
    si, Y = cases.si, cases.Y
    orbits = steady_orbits(
        **{name: si[name] for name in ("m", "c", "k", "K_z", "F_k", "omega")}, Y=Y, threads=threads
    )
    return of_orbits(orbits, Y, si["omega"])
