"""Stated uncertainties of the stiffness, the gains and the timing, propagated into the intervals of an identification.

No record tests the stiffness k or a gain that all channels share, and its harmonics hardly test the gain of one
channel: intervals from noise alone are conditional on them. An error of one stated standard uncertainty shifts the
answer p by Δ_j. These errors are independent of the noise and of each other, so that the covariance C of the noise
becomes

    C + Σ_j Δ_j Δ_jᵀ

(GUM, law of propagation of uncertainty). All records share the stiffness and the transducers, so that the shifts do
not average out.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from ..findings.finding import Finding
from ..records.channel import ACCOMPANYING, EXCITATIONS
from .answer import REFERENCE, Answer
from .loading import correction_of
from .result import B, Result
from .sensitivities import FAULTS, Fault, told

_UNTESTED = {
    "the stiffness": FAULTS["stiffness_1_percent"],
    "the gain of the drive": FAULTS["drive_gain_1_percent"],
    "the gain of the response": FAULTS["response_gain_1_percent"],
}


def with_stated_uncertainties(found: Result[B]) -> Result[B]:
    """Return the identification with errors, intervals and covariances that include the uncertainties stated in its
    options and in the mappings of its records, and with findings on what it depends on."""
    stiffness = found.options.get("stiffness_standard_error_N_per_m") or 0.0
    stiffness = stiffness and stiffness / found.k
    m, m_error = (found.options.get(name) for name in ("mass_kg", "mass_standard_error_kg"))
    of_mass = m_error / m if m else 0.0
    stated = {"stiffness": stiffness, "mass": of_mass, **_stated_of_channels(found)}
    faults = {name: Fault(name, **{name: size}) for name, size in stated.items() if size > 0.0}
    estimates, reference = found.estimates, found.reference
    if faults:
        estimates = {n: widened(one, _shifts(found, faults, n)) for n, one in estimates.items()}
        reference = reference and widened(reference, _shifts(found, faults, REFERENCE))
    mass = m is not None  # with which the records were tested
    hint, effects = _conditional(found, stiffness > 0.0, mass)
    settings = {"stated_uncertainties": {**stated, "mass_tested": mass}}
    return replace(
        found,
        estimates=estimates,
        reference=reference,
        rig=[*found.rig, *filter(None, (hint, Finding("gains"), effects))],
        hint=hint,
        settings={**found.settings, **settings},
    )


def _stated_of_channels(found: Result[Any]) -> dict[str, float]:
    """Return the standard uncertainties that mappings state: of the gains of base or force (drive) and of the channels
    of the mass (response), relative, and of the delay between both (late), s.

    Where records or channels differ, the largest counts, since the channels of the mass are averaged.
    """
    sizes = {True: [(0.0, 0.0)], False: [(0.0, 0.0)]}
    for record in found.records:
        for quantity in {*record.quantities} - {*ACCOMPANYING}:
            known = correction_of(record, quantity)
            of_drive = quantity in EXCITATIONS
            sizes[of_drive].append((known.gain_error / known.gain, known.delay_error))
    drive, response = (np.max(sizes[of_drive], axis=0).tolist() for of_drive in (True, False))
    return {"drive": drive[0], "response": response[0], "late": math.hypot(drive[1], response[1])}


_POWERS = {"m": (0.0, 1.0, 0.0), "f_n": (0.0, -0.5, 0.5), "zeta": (1.0, -0.5, -0.5)}
"""m, f_n and ζ as powers of c, m and k."""


def _shifts(
    found: Result[Any], faults: Mapping[str, Fault], name: str
) -> dict[str, dict[str, float]]:
    """Return the relative changes of the numbers of an answer with faults, and of k, by fault and symbol."""
    shifts = found.shifts(faults, name)
    return {fault: {**of, "k": faults[fault].stiffness} for fault, of in shifts.items()}


def widened(answer: Answer, shifts: Mapping[str, Mapping[str, float]]) -> Answer:
    """Return the answer with its covariance widened by shifts.

    shifts : relative changes of the numbers, by fault and symbol.
    """
    symbols = list(answer.parameters)
    values = np.array([answer.parameters[s].value for s in symbols])
    off = np.array([[of.get(s, 0.0) for s in symbols] for of in shifts.values()])
    # no shifts are known of a fit that does not hold, nor of a rigid contact
    off = np.where(np.isfinite(off), off, 0.0).reshape(-1, len(symbols))
    off *= np.where(np.isfinite(values), values, 0.0)
    sizes = dict(zip(symbols, np.sqrt(np.sum(off**2, axis=0)).tolist(), strict=True))
    covariance = answer.covariance + off.T @ off
    merit = dict(answer.merit)
    if "m_kg" in merit:
        of_mass = [of.get("m", 0.0) * merit["m_kg"] for of in shifts.values()]
        merit["m_standard_error_kg"] = math.hypot(merit["m_standard_error_kg"], *of_mass)
    by = [[of.get(s, 0.0) for s in ("c", "m", "k")] for of in shifts.values()]
    of_rig = np.nan_to_num(by).reshape(-1, 3)
    rig = {
        s: p.wider(float(np.linalg.norm(of_rig @ _POWERS[s])) * abs(p.value))
        for s, p in answer.rig.items()
    }
    return replace(
        answer,
        parameters={s: answer.parameters[s].wider(size) for s, size in sizes.items()},
        covariance=covariance,
        merit=merit,
        rig=rig,
    )


def _conditional(
    found: Result[Any], stiffness: bool, mass: bool
) -> tuple[Finding | None, Finding | None]:
    """Return a finding on what the numbers depend on and the records hardly test, with what to state or give, and one
    on how strongly they depend on it; None where it is stated and tested.

    stiffness : whether its uncertainty is stated.   mass : whether it is given.
    """
    by_mass = mass and found.basis.mass_tests and found.options["stiffness_N_per_m"] is None
    if by_mass:
        k = found.k, found.options["stiffness_standard_error_N_per_m"]
        return Finding("k by the mass", {"k": k}), None
    if stiffness and mass:
        return None, None
    name, answer = next(iter(found.approaches.items()))
    effects = []
    for what, changes in found.shifts(_UNTESTED, name).items():
        parts = tuple(
            (symbol, p.value, share * p.value)
            for symbol, p in answer.parameters.items()
            # an effect of less than 1e-3 of the error itself counts as none
            if math.isfinite(share := changes.get(symbol, 0.0)) and abs(share) > 1e-5
        )
        effects += [(told(found, what), parts)] if parts else []
    if not effects:
        return None, None
    known = found.options.get("stiffness_N_per_m")
    weigh = found.basis.mass_tests and not mass
    hint = {"k": known or 0.0, "state": bool(known) and not stiffness, "weigh": weigh}
    return Finding("conditional", hint), Finding("depends", {"effects": tuple(effects)})
