"""Stated uncertainties of the stiffness, the gains and the timing, carried into the intervals of an identification.

No record tests the stiffness k or a gain: the interval that its noise makes is conditional on both. Where their
standard uncertainties are stated, each shifts an answer p by Δ_j, what an error of one standard uncertainty does to it;
they are independent of the noise and of each other, so that the covariance C of the noise becomes

    C + Σ_j Δ_j Δ_jᵀ

(GUM, law of propagation of uncertainty). A stiffness or a transducer is common to all records: the shifts of the
records do not average out.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from ..project.wording import listed
from ..records.measured import MeasuredRecord
from ..records.measurement import EXCITATIONS, Correction
from ..solver import NORMAL_95
from .answer import Answer, Interval, ParameterEstimate
from .outcome import Outcome
from .sensitivities import Fault

_FELT = 1e-3  # of an effect of a part of the same size: what is said of less is that it is nothing


class Stated(NamedTuple):
    """Standard uncertainties.

    stiffness, drive, response : of k and of the gains of base or force and of the mass's channels, as parts of them.
    late : of the delay between both, s.
    """

    stiffness: float = 0.0
    drive: float = 0.0
    response: float = 0.0
    late: float = 0.0

    @property
    def faults(self) -> dict[str, Fault]:
        """The faults of one standard uncertainty each, by name, without those that are not stated."""
        return {
            name: Fault(name, **{name: size}) for name, size in self._asdict().items() if size > 0.0
        }


def stated_in(records: Iterable[MeasuredRecord], stiffness: float) -> Stated:
    """What the mappings of records state of their channels.

    The largest counts where records or channels differ: channels of the mass are averaged, and which of them an error
    is of, is not known.

    stiffness : standard uncertainty of k, as a part of it.
    """
    corrections: dict[str, list[Correction]] = {}
    for record in records:
        rules = record.rules.channels
        for quantity in record.quantities:
            own = record.measurement[quantity].correction if record.measurement else None
            known = own or (rules[quantity].correction if quantity in rules else None)
            corrections.setdefault(quantity, []).append(known or Correction())
    largest = {
        q: (max(c.gain_error / c.gain for c in of), max(c.delay_error for c in of))
        for q, of in corrections.items()
    }
    drive = [largest[q] for q in largest if q in EXCITATIONS]
    response = [largest[q] for q in largest if q not in EXCITATIONS]
    (gain, delay), (own_gain, own_delay) = (
        np.max([(0.0, 0.0), *sizes], axis=0).tolist() for sizes in (drive, response)
    )
    return Stated(stiffness, gain, own_gain, math.hypot(delay, own_delay))


def carried(outcome: Outcome, stated: Stated, *, mass: bool) -> Outcome:
    """An outcome whose errors, intervals and covariances hold what is stated, and which says on what it depends.

    mass : whether a mass was given, with which the records were tested.
    """
    faults = stated.faults
    estimates, reference = outcome.estimates, outcome.reference
    if faults:
        shifts = outcome.shifts(faults, list(outcome.answers))
        estimates = {name: _widened(one, shifts.get(name, {})) for name, one in estimates.items()}
        reference = reference and _widened(reference, shifts.get(reference.name, {}))
    settings = {"stated_uncertainties": {**stated._asdict(), "mass_tested": mass}}
    return replace(
        outcome,
        estimates=estimates,
        reference=reference,
        rig=[*outcome.rig, *_conditional(outcome, stated, mass)],
        settings={**outcome.settings, **settings},
    )


def _widened(answer: Answer, shifts: Mapping[str, Mapping[str, float]]) -> Answer:
    """The answer with its covariance widened by shifts, relative to its values, by fault and symbol."""
    symbols = list(answer.parameters)
    values = np.array([answer.parameters[s].value for s in symbols])
    off = np.array([[of.get(s, 0.0) for s in symbols] for of in shifts.values()]) * values
    off = np.where(np.isfinite(off), off, 0.0).reshape(-1, len(symbols))
    sizes = np.sqrt(np.sum(off**2, axis=0))
    parameters = {
        s: _wider(answer.parameters[s], float(size)) for s, size in zip(symbols, sizes, strict=True)
    }
    covariance = answer.covariance + off.T @ off
    errors = np.sqrt(np.diag(covariance))
    correlations = {
        (a, b): float(covariance[i, j] / (errors[i] * errors[j]))
        for (a, b) in answer.correlations
        for i, j in [(symbols.index(a), symbols.index(b))]
    }
    merit = dict(answer.merit)
    if "m_kg" in merit:
        of_mass = [of.get("m", 0.0) * merit["m_kg"] for of in shifts.values()]
        merit["m_standard_error_kg"] = math.hypot(merit["m_standard_error_kg"], *of_mass)
    return replace(
        answer,
        parameters=parameters,
        covariance=covariance,
        correlations=correlations,
        merit=merit,
    )


def _wider(p: ParameterEstimate, size: float) -> ParameterEstimate:
    """An estimate with an independent error of this standard deviation more, in quadrature at either end."""
    if not (size > 0.0 and math.isfinite(p.value)):
        return p
    reach = NORMAL_95 * size
    low = p.value - math.hypot(p.value - p.interval.low, reach)
    high = p.value + math.hypot(p.interval.high - p.value, reach)
    return replace(
        p, standard_error=math.hypot(p.standard_error, size), interval=Interval(low, high)
    )


def _conditional(outcome: Outcome, stated: Stated, mass: bool) -> list[str]:
    """A sentence on what the numbers depend on and no record tests; none where it is stated and tested."""
    if stated.stiffness > 0.0 and mass:
        return []
    name, answer = next(iter(outcome.answers.items()))
    faults = {
        "the stiffness": Fault("", stiffness=0.01),
        "the gain of the drive": Fault("", drive=0.01),
        "the gain of the response": Fault("", response=0.01),
    }
    effects = []
    for what, changes in outcome.shifts(faults, [name]).get(name, {}).items():
        parts = [
            f"{symbol} by {100.0 * change:+.2g} %"
            for symbol in answer.parameters
            if math.isfinite(change := changes.get(symbol, 0.0)) and abs(change) > 0.01 * _FELT
        ]
        effects += [f"1 % in {what} changes {listed(parts)}"] if parts else []
    if not effects:
        return []
    asked = ["state their uncertainties (--stiffness 2310±10)"] * (stated.stiffness == 0.0)
    asked += ["give the mass (--mass), which tests them"] * (not mass)
    return [
        "All numbers are conditional on the stiffness and the gains, which the records alone cannot test: an error of "
        f"{'; '.join(effects)}. To be sure of them, {listed(asked)}."
    ]
