"""What harmonics beyond those that are fitted add to the harmonics of a record, from the oscillator that it is of.

The contact ends and begins to stick at once, so that the jerk jumps and the harmonics of the acceleration fall as
n^{−2} only. Least squares, cycle by cycle, take them up to a quarter of the samples per cycle; what lies beyond leaks
into these and folds back, differently in each cycle. In the mean that is a bias, where the number of samples per cycle
is nearly whole or half of that; otherwise it scatters like noise many times larger than the transducer's. The exact
motion of the oscillator holds these harmonics: sampled at the times of the record, and behind the filters that the
mapping names, they are taken through the same least squares, and what these give is subtracted from every cycle. Then
the oscillator is fitted again. An anti-alias filter that nobody names shows in the scatter, which does not fall then,
and in the fit: the records are left as they were where they fit better so.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ..arrays import Array, Complexes
from ..law.law import Law
from ..law.steady import Response
from ..motion.events import PHASE_T
from ..motion.orbit import Orbit
from ..reading.conditioning import SteadyRecord
from ..reading.cycles import accumulate
from ..reading.lines import Lines
from ..reading.one_thread import one_thread
from ..records.measurement import ORDERS, RESPONSES, Correction
from .base_harmonics import MOST, PATIENCE, fit_records, of_harmonic_base, repeated, settled
from .mean_harmonics import Reading
from .steady_search import climb_on
from .waveforms import WaveformFit

_DENSE = 8192  # points of a cycle that is exact
_FINER = 8  # how many more of them are interpolated
_LOW = 7  # a harmonic so high still shows the contact
# Errors of a record that has been freed over those before: beyond, the motion was another.
_WORSE = 1.02
_SPLIT = 1e-6  # of ω_n: roots are kept apart by that, and damping above zero
_SHOWS = 16.0  # of χ²: four standard errors


@one_thread
def unfolded(
    readings: Sequence[Reading], k: float, law: Law | None = None
) -> tuple[list[Reading], WaveformFit | None]:
    """The readings freed of what harmonics beyond those that are fitted add to them, and the fit that says what they
    are; the readings as they are, and None, where that does not matter or no oscillator explains it.

    Use it before a fit of one oscillator to records of accelerations with less than some hundred samples to the cycle.
    """
    concerned = [_folds(reading.steady) for reading in readings]
    if not any(concerned):
        return list(readings), None
    first = fit_records([reading.lines for reading in readings], k, law, thorough=False)
    if first is None:
        return list(readings), None
    freed, fit = _repeated(readings, concerned, first, PATIENCE)
    if fit is not None and not fit.adequate:
        # high harmonics, which fold most for their size, have led elsewhere
        low = [reading.lines.up_to(_LOW) for reading in readings]
        again = fit_records(low, k, law)
        if again is not None:
            ends = (freed, fit), _repeated(readings, concerned, again)
            freed, fit = min(ends, key=lambda end: end[1].chi_square if end[1] else math.inf)
    if fit is None or (first.adequate and not fit.adequate):
        return list(readings), None
    # with the same errors
    kept = [
        replace(new.lines, x=old.steady.x_of(new.lines.n))
        for old, new in zip(readings, freed, strict=True)
    ]
    folded = climb_on(fit, kept)
    if folded is not None and settled(folded, kept).chi_square < fit.chi_square - _SHOWS:
        return list(readings), None
    return freed, fit


def _repeated(
    readings: Sequence[Reading], concerned: Sequence[bool], fit: WaveformFit, patience: int = MOST
) -> tuple[list[Reading], WaveformFit | None]:
    """The readings freed of what the oscillator adds to them that fits them then; None in place of that fit where there
    is none.   patience : as for `base_harmonics.repeated`."""
    freed = list(readings)

    def lines(responses: Sequence[Response]) -> list[Lines]:
        freed[:] = [
            _freed(reading, response) if folds else reading
            for reading, response, folds in zip(readings, responses, concerned, strict=True)
        ]
        return of_harmonic_base([reading.lines for reading in freed], responses)

    return freed, repeated(fit, lines, patience)


def _folds(steady: SteadyRecord) -> bool:
    """Whether harmonics beyond those that are fitted, which fall as n^{−2} in the acceleration, matter next to the
    noise, in the scatter or in the mean."""
    if steady.cycles_per_row > 1:
        return False
    for quantity in RESPONSES.keys() & steady.channels.keys():
        channel, order = steady.gathered.channels[quantity], ORDERS[quantity]
        # as far as the filters of some channel pass them; beyond those fitted only what those of this one pass folds
        fitted = channel.coefficients.shape[1]
        highest = np.arange(1, min(fitted, steady.X.shape[1]), 2)[-3:]
        size = np.median(
            np.abs(steady.mean(steady.X[:, highest])) * (highest * steady.omega) ** order
        )
        passed = abs((channel.correction or Correction()).response(fitted * steady.omega))
        beyond = size * passed * math.sqrt(highest[-1] / (4.0 * (7 - 2 * order)))
        if beyond > steady.noise_rms[quantity] / math.sqrt(steady.cycles):
            return True
    return False


def _freed(reading: Reading, response: Response) -> Reading:
    """A reading freed of what the harmonics of a motion add to those that were fitted; the reading itself where that
    leaves more scatter."""
    steady = reading.steady
    freed = steady.without(
        {q: _beyond(steady, q, response) for q in RESPONSES if q in steady.channels}
    )
    n = np.arange(3, len(steady.X_error))
    if np.median(freed.X_error[n] / steady.X_error[n]) > _WORSE:
        return reading
    return replace(reading, steady=freed)


def _beyond(steady: SteadyRecord, quantity: str, response: Response) -> Complexes:
    """What harmonics of a motion beyond those that are fitted add to these in each cycle of a channel, rows ×
    (0 … N), in the unit of the channel as it was recorded."""
    channel = steady.gathered.channels[quantity]
    first, dt, correction = channel.first, channel.dt, channel.correction or Correction()
    orbit, order = response.orbit, ORDERS[quantity]
    spectrum = np.fft.rfft(_cycle(orbit, order))
    n = np.arange(spectrum.size)
    if response.change is not None:
        odd = np.arange(1, 2 * response.change.size, 2)
        spectrum[odd] += 0.5 * _DENSE * (1j * odd * steady.omega) ** order * response.change
    base, late = np.angle(steady.mean(steady.Y[:, 1:2])[0]), steady.skew.get(quantity, 0.0)
    phase = response.advance - orbit.theta + float(base) - steady.omega * late
    spectrum *= np.exp(1j * n * phase) * correction.response(n * steady.omega)
    spectrum[: channel.coefficients.shape[1]] = 0.0
    cycle = _FINER * np.fft.irfft(spectrum, _FINER * _DENSE)
    duration = len(channel.weights) * 2.0 * math.pi / channel.omega
    number = np.arange(
        max(0, math.floor((channel.start - first) / dt) - 1),
        math.ceil((channel.start + duration - first) / dt) + 2,
    )
    t: Array = first + dt * number.astype(np.float64)
    place = np.mod(steady.omega / (2.0 * math.pi) * (t - channel.start), 1.0) * cycle.size
    values = np.interp(place, np.arange(cycle.size + 1), np.append(cycle, cycle[0]))
    rows = accumulate(
        iter([(t, values)]),
        channel.omega,
        start=channel.start,
        dt=dt,
        harmonics=channel.coefficients.shape[1] - 1,
        cycles=len(channel.weights),
    ).coefficients
    beyond = np.zeros_like(channel.coefficients)
    beyond[: len(rows)] = np.nan_to_num(rows)
    return beyond


def _cycle(orbit: Orbit, order: int) -> Array:
    """The derivative of x of an order at equal steps from the reversal at −X on, SI, (_DENSE,).

    Each phase is Re B e^{iωt}, a rest and Σ C e^{λt}, λ = −δ ± (δ² − Ω²)^{1/2}: all points at once, to some digits less
    than the kernels, of which a fold needs four. Uncompiled, these would take a second.
    """
    osc, omega = orbit.oscillator, orbit.motion.omega
    t = np.arange(_DENSE // 2) * (orbit.motion.period / _DENSE)
    half, delta = np.empty(t.size), 0.5 * osc.c / osc.m
    begins = np.append(orbit.phases[:, PHASE_T], math.inf)
    for i, (begin, s, x, v, z) in enumerate(orbit.phases.tolist()):
        within = (t >= begin) & (t < begins[i + 1])
        since = t[within] - begin
        kappa, force = (osc.k + osc.K_z, osc.K_z * (z - x)) if s == 0.0 else (osc.k, s * osc.F_k)
        stiffness = kappa - omega**2 * osc.m + 1j * omega * max(osc.c, _SPLIT * osc.omega_n * osc.m)
        B = osc.k * orbit.motion.Y * cmath.exp(1j * (orbit.theta + omega * begin)) / stiffness
        root = cmath.sqrt(delta**2 - kappa / osc.m)
        if abs(root) < _SPLIT * osc.omega_n:  # critical damping
            root = _SPLIT * osc.omega_n + 0j
        one, other = -delta + root, -delta - root
        q, w = x + force / kappa - B.real, v - (1j * omega * B).real
        C, D = (w - other * q) / (one - other), (one * q - w) / (one - other)
        motion = (1j * omega) ** order * B * np.exp(1j * omega * since)
        motion += one**order * C * np.exp(one * since) + other**order * D * np.exp(other * since)
        half[within] = motion.real - (force / kappa if order == 0 else 0.0)
    return np.concatenate([half, -half])
