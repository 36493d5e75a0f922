"""Exact steady responses of oscillators with any damping law, as features with the integrals of its terms."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import replace
from typing import Any

import numpy as np
from scipy.optimize import brentq

from ..arrays import Array, Complexes
from ..features import Features, of_numbers, of_orbit, wrapped
from ..law.integrals import of_harmonics
from ..law.steady import Response, steady_response
from ..model import BaseMotion, Oscillator
from ..motion.orbit import NoSteadyOrbit
from ..motion.regime import Regime
from .parameters import OF_LAW
from .responses import Cases, one_by_one

_HARMONICS = 128  # odd ones: what lies beyond takes 1e-9 of the work or less


def law_responses(cases: Cases, terms: Iterable[str]) -> Features:
    """The steady responses of n cases at L levels, as features of shape (L, n).

    terms : symbols of the further terms to integrate.
    """
    si, terms = cases.si, list(terms)

    def response(osc: Oscillator, motion: BaseMotion, case: int) -> Features:
        law = {symbol: float(si[symbol][case]) for symbol in OF_LAW.values() if symbol in si}
        try:
            return of_response(steady_response(osc, motion, law), motion, osc.k, terms)
        except NoSteadyOrbit:
            nothing = {symbol: np.full(1, np.nan) for symbol in terms}
            return of_numbers(motion.omega, str(Regime.NOT_FOUND), integrals=nothing)

    return one_by_one(cases, response)


def of_response(
    response: Response, motion: BaseMotion, k: float, terms: Iterable[str] = ()
) -> Features:
    """Features of one steady response under any law, (1,).

    motion : of the base.   k : spring to the base, N/m.   terms : symbols of the further terms to integrate.
    """
    omega, n = motion.omega, np.arange(1.0, 2.0 * _HARMONICS, 2.0)
    x = response.harmonics(_HARMONICS)
    base = np.ones(1), np.full((1, 1), complex(motion.Y))
    integrals = {s: of_harmonics(s, n, x[None], *base, omega, k) for s in ("c", *terms)}
    reversal = float(wrapped(response.orbit.theta - response.advance - math.pi))
    changed: dict[str, Any] = {
        "Y": np.array([motion.Y]),
        "X": response.X,
        "phi": reversal,
        "phi_reversal": reversal,
        "phi_zero_crossing": float(wrapped(_upward_crossing(n, x, reversal) + 0.5 * math.pi)),
        "phi_fundamental": float(wrapped(-np.angle(x[0]))),
        "b": integrals.pop("c"),
        "W": -math.pi * k * motion.Y * x[0].imag,
        **{f"X_{order}": abs(x[i]) for i, order in enumerate((1, 3, 5))},
    }
    if response.change is not None and response.slips:
        X_s = 2.0 * response.orbit.oscillator.Z_m - response.X
        changed |= {"X_s": X_s, "V_s": response.V_s, "t_s": response.t_s}
        changed |= {"X_r": -X_s, "V_r": -response.V_s, "t_r": response.t_s}
        changed |= {"a": 4.0 * response.X - response.taken}
    return replace(of_orbit(response.orbit), **changed, integrals=integrals)


def _upward_crossing(n: Array, x: Complexes, reversal: float) -> float:
    """Phase ωt of the upward zero crossing that precedes the reversal at +X, rad."""

    def displacement(theta: float) -> float:
        return float((x * np.exp(1j * n * theta)).real.sum())

    return float(brentq(displacement, reversal - math.pi, reversal, xtol=1e-14))
