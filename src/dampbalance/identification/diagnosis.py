"""Findings from the fit of one oscillator to all forced records: departures, a wrong mass or stiffness, a contact that
only sticks, records that no oscillator explains."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from ..findings.finding import Finding
from ..fit.fit import OscillatorFit
from ..fit.goodness import LinearFit
from ..fit.waveforms import WaveformFit
from ..signals.mean_harmonics import Reading
from ..signals.thresholds import CERTAIN
from .answer import USELESS, Answer
from .balance_check import alike
from .causes import FRAME, as_damper, doubts_of, unseen_turns
from .oscillator import CommonFit
from .weighing import said_of

_WORSE_IN_ROWS = {"clipped", "unsettled"}
_RESONANCE = 0.3  # part of a harmonic: where more of it is not fitted, a mode is near it, and not near the fundamental
_SYSTEMATIC = 10.0  # residual/noise of the fundamentals that is no scatter, whatever the noise was taken to be
_SAME_LEVEL = 0.05  # of ln X: levels that do not show how anything depends on X
_STUCK = {True: "stuck", False: "loose", None: "linear"}


def on_records(readings: Sequence[Reading], common: CommonFit) -> list[Finding]:
    """Return the findings on single records. A drive that is not harmonic does no harm where an oscillator explains the
    fundamentals within noise, and a rare ratio of amplitudes is no sign of a wrong unit where one explains it."""
    fit = common.fit
    holds = fit is not None and fit.adequate and fit.problem.scales[0] == 1.0
    found = [one.about(reading.steady.source) for reading in readings for one in reading.warnings]
    explained = common.stuck is not None or common.waveforms_hold
    found = [one for one in found if not (explained and one.numbers.get("rare"))]
    harmless = {"base": "base within noise"} if holds else {}
    return [replace(one, code=harmless.get(one.code, one.code)) for one in found]


def agreement(readings: Sequence[Reading], common: CommonFit, direct: Answer) -> Iterator[Finding]:
    """Yield the findings on all records together: those of the common fit, levels that only stick, and coefficients
    that the balance by direct integration hardly distinguishes."""
    yield from on_the_oscillator(readings, common)
    if still := [str(i) for i, of in enumerate(readings, 1) if of.slips is False]:
        yield Finding("only sticks", {"records": ", ".join(still)})
    fit = common.fit if common.waveforms_hold else None
    if fit is not None and not fit.interval("rho")[0] > 0.0:
        yield Finding("unresolved", effect={"K_z": math.inf})
    if {"c", "c_r"} <= {*direct.coefficients}:
        by = 1e-6 * readings[0].steady.k
        yield Finding("skewed", {"by": by}, {"c": math.inf, "c_r": math.inf})
    yield from alike(direct)


def not_in_rows(readings: Sequence[Reading], common: CommonFit) -> list[str]:
    """Return, by the names of models, what the rows of the balance suffer from more than the fit does: clipped cycles,
    a motion that drifts, departures."""
    codes = dict.fromkeys(one.code for reading in readings for one in reading.warnings)
    return [*filter(_WORSE_IN_ROWS.__contains__, codes), *common.in_rows]


def on_the_oscillator(readings: Sequence[Reading], common: CommonFit) -> Iterator[Finding]:
    """Yield findings from the common fit."""
    if common.stuck is not None:
        yield Finding(_STUCK[common.stuck.sticks])
        yield from _too_stiff(readings, common.stuck, common.mass)
        return
    fit, of = common.fit, common.selection
    if of is not None:
        assert fit is not None
        frame = Finding(FRAME, {"absolute": bool(fit.lines[0].of_base)})
        for one in said_of(of, {FRAME: frame, **as_damper(of, readings)}):
            yield replace(one, effect=doubts_of(of, *(what.code for what in one.numbers["what"])))
        yield from unseen_turns(of)
    if common.mass is not None and not common.mass_fits:
        by_force = any("force" in reading.steady.channels for reading in readings)
        yield on_mass(common.closest, common.mass, by_force)
    if fit is None:
        yield Finding("no oscillator")
    elif not common.waveforms_hold and FRAME not in common.clear:
        worst = readings[int(np.argmax(fit.misfits))].steady.source
        main, others = fit.problem.scales
        numbers = {"fundamentals": main, "harmonics": others, "worst": worst}
        # fundamentals alone do not tell a contact that yields gradually from one of another stiffness
        effect = {**_by_distortion(fit), "K_z": math.inf}
        if (
            main > _SYSTEMATIC
        ):  # an error that follows from such a residual is a bound only where it is small
            wide = [s for s in fit.law.unknowns if 2.0 * fit.error(s) > USELESS * abs(fit.value(s))]
            effect |= dict.fromkeys(wide, math.inf)
        yield Finding("far from all", numbers, effect)


def _by_distortion(fit: WaveformFit) -> dict[str, float]:
    """Return the relative error that each coefficient of a fit may have by a linear distortion of the response, such as
    an echo; empty where the third harmonics show none.

    A distortion changes every harmonic of all levels by a part of it. Next to the fundamentals the harmonics hardly
    count, and the fit takes the change of the fundamental for damping. That of the third shows how large it is: a part
    h of the fitted one, whatever the level. Other causes change the third harmonic by a part that depends on the level:
    a contact that yields gradually by a part ∝ 1/X, a spring, a sensor or another mode by a part ∝ X. For a part ∝ X^p,
    the fundamentals are taken to be off by h · min(1, 2 − 2|p|).
    """
    main, others = fit.problem.scales
    rows, gain = list[tuple[float, float, float]](), np.zeros(fit.problem.samples, dtype=complex)
    for one, place in zip(fit.lines, fit.problem.places, strict=True):
        read = one.x - np.where(one.n == 1, one.of_base * one.Y, 0.0)
        ratio = read / one.x_error / np.where(one.n == 1, main, others)
        gain[place] = np.concatenate([[0.0, 0.0], ratio, -1j * ratio])  # Re x_n, Im x_n of a gain
        if one.n.size > 1:
            left = others * complex(*fit.residual[place][[3, 3 + one.n.size]])
            model = abs(one.x[1] / one.x_error[1] + left)
            if abs(left) > CERTAIN and model > 0.0:
                rows.append((math.log(abs(one.x[0])), math.log(abs(left) / model), abs(left)))
    if len(rows) < 2:
        return {}
    X, part, weights = np.transpose(rows)
    p = float(np.polyfit(X, part, 1, w=weights)[0]) if np.ptp(X) > _SAME_LEVEL else 0.0
    h = math.exp(float(np.average(part, weights=weights**2)))
    if h > _RESONANCE or abs(p) >= 1.0:
        return {}
    h *= min(1.0, 2.0 - 2.0 * abs(p))
    keys = [key for key in fit.law.unknowns if fit.value(key)]
    by = fit.response[[fit.parameters.places[key] for key in keys]]
    sizes = np.abs(by @ gain).tolist()  # by the gain and by a turn of the phase
    return {key: h * abs(size / fit.value(key)) for key, size in zip(keys, sizes, strict=True)}


def _too_stiff(
    readings: Sequence[Reading], stuck: LinearFit, mass: float | None
) -> Iterator[Finding]:
    """Yield a finding where a contact that only sticks would have a negative stiffness: the given stiffness is too high
    by at least as much, since a contact can only add to that of the spring."""
    if stuck.contact >= -CERTAIN * stuck.contact_error:
        return
    steady = readings[0].steady
    of_base = "force" not in steady.channels and steady.base_mass is None and mass is not None
    # a base that moves shows k/m, a force k itself
    left = (mass or 0.0) * stuck.by_mass if of_base else stuck.k + stuck.contact
    too_high = -stuck.contact / left if left > 0.0 else 0.0
    yield Finding("too stiff", {"too_high": too_high}, {"": too_high or math.inf})


def on_mass(fit: OscillatorFit, mass: float, by_force: bool = False) -> Finding:
    """Return the finding that the records contradict a mass, and that each number may be off by as much.

    m, c, k, K_z and F_k, all times the same number, are an oscillator of the same motion: if the mass is right, the
    stiffness is likely wrong, and all numbers by the same factor.

    mass : kg, as given.   by_force : whether a load cell measures the drive, and carries what is between it and the
    mass.
    """
    ratio = mass / fit.m
    meant = tuple(
        (symbol, fit.k if symbol == "k" else mass, unit)
        for (symbol, unit), factor in _MISTAKEN.items()
        if abs(ratio / factor - 1.0) < _CLOSE
    )
    fixture = by_force and 0.5 < ratio < 1.0
    numbers = {"masses": (fit.m, mass), "fixture": fixture, "meant": meant}
    return Finding("mass", numbers, {"": abs(ratio - 1.0)})


_CLOSE = (
    0.03  # relative deviation from a factor of two units: errors of gains and of a guessed mass
)
_MISTAKEN = {  # quantity, unit → factor by which the mass is too large, or the stiffness too small, if that was meant
    ("k", "N/mm"): 1000.0,
    ("m", "g"): 1000.0,
    ("k", "N/cm"): 100.0,
    ("k", "kgf/m"): 9.80665,
    ("m", "N"): 9.80665,
    ("k", "kgf/mm"): 9806.65,
    ("k", "lbf/in"): 175.127,
    ("k", "lbf/ft"): 14.5939,
    ("m", "lb"): 2.20462,
    ("m", "oz"): 35.274,
}
