"""Separate fits of the bursts, from a turn on over a growing part of each: the starts of the joint fit.

At a turn p of a free motion that slips, ẋ = 0 and z = ±F_k/K_z. Its next turns follow from the swings before and after,

    D_{i+1} = e^{−βπ} D_i − 2(1 + e^{−βπ}) F_k/k,      β = ζ/√(1 − ζ²),

for several shares of friction in what the swing loses, and for a few stiffnesses of the contact. The closest of these
are climbed from over the first cycle, and the fit follows the burst to its end. A mass at rest may ring on the contact,
and the spectral line of that ringing gives K_z. Then the start is moved back for as long as the samples
follow the motion: what held or pushed the mass before is left out.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Sequence
from dataclasses import replace

import numpy as np

from ..arrays import Array
from ..motion.events import PHASE_V, PHASE_X
from .ringdown_bursts import Burst, Signal, bursts_of, sharpest
from .ringdown_fit import RingFit, fit_stretches, with_noise_of
from .ringdown_motion import COMMON, STATE, Stretch, samples_of, slips, stuck_from

_SHARES = (0.05, 0.35, 0.65, 0.95)  # of friction in what the swing loses
_STIFFNESSES = (4.0, 30.0, 300.0)  # of K_z/k
_MASSES = (0.85, 1.0, 1.15)  # relative to that of the period
_CLIMBED = 4  # candidates
_FIRST = 1.0  # cycles that are fitted first
_GROWTH = 2.0  # of the fitted part from one climb to the next
_COARSE = 1e-2  # of half of χ², where a climb on the way ends
_PIECES = 12  # of a cycle, in which the mass is looked at for rest
_BACK = 24  # steps of a cycle in which the start moves back
_LEFT = 3e-4  # probability of what new samples add to χ²
_SEVERAL = 3  # steps back that are looked at together
_AGREES = 3.0  # standard deviations of the scatter of a mass at rest
_CHANCE = 1e-4  # probability of a line of the spectrum in noise
_AFTER = 0.02  # of a cycle, that is kept where the mass sticks and does not ring
_FEW = 16  # samples
_GRASPED = 4.0  # of χ², beyond what the choice of an instant makes
_PART = 0.1  # of the swing of a burst, that its motion has at least
_DISTURBED = 0.02  # probability of a residual after which a burst ends before the next one
_ALIKE = 1.5  # χ² per sample of a fit that needs no other start


def stretches_of(
    source: str, signals: Sequence[Signal], k: float, offsets: Sequence[int]
) -> list[RingFit]:
    """A fit of each burst in the channels of a record by itself, in their order; those that no oscillator fits are
    left out.

    offsets : numbers of the offsets of the channels.   Raises NoDecay.
    """
    fits: list[RingFit] = []
    lead = sharpest(signals)
    for burst in bursts_of(lead):
        since = fits[-1].stretches[0].start if fits else burst.earliest
        whole = Stretch(source, burst.turn, burst.end, tuple(signals), tuple(offsets), burst.period)
        fit = _grown(whole, burst, lead, k)
        if fit is None:
            continue
        if fit.adequate:  # its residual gives the noise better than the samples alone
            fit = with_noise_of(fit)
            known = zip(whole.signals, fit.stretches[0].signals, strict=True)
            signals_of = tuple(replace(one, noise=other.noise) for one, other in known)
            whole = replace(whole, signals=signals_of)
        fit = refit_from_other_starts(_from_earlier(fit, whole, max(since, burst.earliest)))
        if not burst.last:
            fit = _until_grasped(fit)
        if _moves(fit) > _PART * burst.swing:  # else the swing was not that of a free motion
            fits.append(fit)
    for good in (lambda fit: fit.adequate, lambda fit: slips(fit.phases(0))):
        fits = [fit for fit in fits if good(fit)] or fits
    return fits


def _grown(whole: Stretch, burst: Burst, lead: Signal, k: float) -> RingFit | None:
    """The fit of a burst from its turn on."""
    end = min(burst.turn + _FIRST * burst.period, burst.end)
    part = whole.cut(burst.turn, end)
    if part.samples < 4 * (len(COMMON) + STATE):
        return None
    fit = None
    for start in _candidates(part, burst, lead, k)[:_CLIMBED]:
        w = start.size - 1
        reached = fit_stretches([part], k, start, given={w}, gain=_COARSE)
        if reached is not None and (fit is None or reached.chi_square < fit.chi_square):
            fit = reached
            if fit.chi_square < _ALIKE * part.samples:
                break
    if fit is not None:
        fit = _longer(fit, part)
    while fit is not None and end < burst.end:
        end = min(burst.turn + _GROWTH * (end - burst.turn), burst.end)
        if burst.end - end < 0.25 * burst.period:
            end = burst.end
        longer = _longer(fit, whole.cut(burst.turn, end))
        if longer is None:
            break
        if not burst.last and longer.chance < _DISTURBED <= fit.chance:
            # something else moves the mass before the next burst
            return _until_disturbed(fit, whole, end)
        fit = longer
    return fit and refit_from_other_starts(fit, {fit.point.size - 1})


def refit_from_other_starts(fit: RingFit, given: Collection[int] = ()) -> RingFit:
    """The fit, or where its residual is unlikely to be noise the best of those that start from other shares of friction
    in the loss, and for a single decay from the contact at either end.

    given : numbers of the unknowns that keep their values.
    """
    if not fit.doubtful:
        return fit
    phases = fit.phases(0)
    travel = float(np.abs(np.diff(phases[:, PHASE_X])).sum())
    speed = float(np.abs(phases[:, PHASE_V]).max())
    # ∫ ẋ² dt of half a cycle is π/4 of the top speed times the travel
    ratio = 0.25 * math.pi * speed
    loss = (fit.F_k + ratio * fit.c) * travel
    best = fit
    for share in _SHARES if loss > 0.0 else ():
        for w in (fit.point[-1],) if given or len(fit.stretches) > 1 else (0.0, 2.0):
            start = fit.point.copy()
            start[0], start[1] = share * loss / travel, (1.0 - share) * loss / (ratio * travel)
            start[-1] = w
            other = fit_stretches(fit.stretches, fit.k, start, given=given, gain=_COARSE)
            if other is not None and other.chi_square < best.chi_square:
                best = other
    return best


def _longer(fit: RingFit, part: Stretch) -> RingFit | None:
    """The fit of a longer part, from a shorter one on."""
    w = fit.point.size - 1
    part = _without_ringing(fit, part)
    best = fit_stretches([part], fit.k, fit.point, given={w}, gain=_COARSE)
    for rho in _ringing(best or fit, part):
        start = (best or fit).point.copy()
        start[2] = rho
        other = fit_stretches([part], fit.k, start, given={w}, gain=_COARSE)
        if other is not None and (best is None or other.chi_square < best.chi_square):
            best = other
    return best


def _until_disturbed(fit: RingFit, whole: Stretch, end: float) -> RingFit:
    """The fit up to where the samples leave the motion, before `end`."""
    start, good = whole.start, fit.stretches[0].end
    while end - good > 0.1 * whole.period:
        middle = 0.5 * (good + end)
        longer = _longer(fit, whole.cut(start, middle))
        if longer is not None and longer.chance >= _DISTURBED:
            fit, good = longer, middle
        else:
            end = middle
    if good - start > 2.0 * whole.period:  # the disturbance may show late
        fit = _longer(fit, whole.cut(start, good - 0.5 * whole.period)) or fit
    return fit


def _until_grasped(fit: RingFit) -> RingFit:
    """The fit, truncated where the ringing mass is caught before the next release."""
    (one,), (row,) = fit.stretches, fit.residuals()
    still = _still(fit, one.end)
    ends = []
    for signal, residual in zip(one.signals, row, strict=True):
        first = int(np.searchsorted(signal.t, still))
        tail, off = signal.values[first:], residual[first:]
        if tail.size < _FEW:
            continue
        level = tail[-(tail.size // 4) :].mean()
        # evidence of the samples from each one on for a level, against the motion
        gain = off**2 - ((tail - level) / signal.noise) ** 2
        after = np.cumsum(gain[::-1])[::-1]
        best = int(np.argmax(after))
        if after[best] > 2.0 * math.log(tail.size) + _GRASPED:
            ends.append(float(signal.t[first + best]))
    if not ends:
        return fit
    return fit_stretches([one.cut(one.start, min(ends))], fit.k, fit.point, gain=_COARSE) or fit


def _candidates(part: Stretch, burst: Burst, lead: Signal, k: float) -> list[Array]:
    """Start points from the swings before and after the turn, the closest first."""
    omega = 2.0 * math.pi / burst.period
    of_lead = next(s for s in part.signals if s.quantity == lead.quantity)
    ahead = of_lead.values[of_lead.between(burst.turn, burst.turn + 0.6 * burst.period)]
    next_swing = min(float(np.ptp(ahead)) / omega**lead.order, burst.swing)
    lost = max(burst.swing - next_swing, 1e-3 * burst.swing)
    candidates = []
    for share in _SHARES:
        ratio = min(max(1.0 - (1.0 - share) * lost / burst.swing, 0.5), 0.9999)
        zeta = -math.log(ratio) / math.hypot(math.pi, math.log(ratio))
        friction = share * lost / 4.0
        x = burst.side * (next_swing / (1.0 + ratio) + friction)
        for mass in _MASSES:
            m = mass * k / omega**2
            for stiffness in _STIFFNESSES:
                common = (
                    k * friction,
                    2.0 * zeta * math.sqrt(k * m),
                    1.0 / math.sqrt(stiffness * k),
                    m,
                )
                state = np.array([x, 0.0, 1.0 + burst.side])
                start = np.concatenate([common, np.zeros(max(part.offsets) + 1), state])
                try:
                    model = samples_of(start, state, k, part)
                except ValueError:
                    continue
                misfit, at = 0.0, 0
                for signal, offset in zip(part.signals, part.offsets, strict=True):
                    off = signal.values - model[at : at + signal.t.size]
                    at += signal.t.size
                    start[len(COMMON) + offset] = off.mean()
                    misfit += float(np.var(off)) * signal.t.size / signal.noise**2
                candidates.append((misfit, start))
    candidates.sort(key=lambda one: one[0])
    return [start for _, start in candidates]


def _ringing(fit: RingFit, part: Stretch) -> Iterator[float]:
    """ρ of the contact on which the mass at rest rings, where that shows: K_z = mΩ² − k."""
    still = _still(fit, part.end)
    slipping = math.sqrt(fit.k / fit.m)
    for signal in part.signals:
        inside = signal.between(still + 0.25 * part.period, part.end)
        values = signal.values[inside]
        if values.size < 16:
            continue
        values = values - values.mean()
        padded = 4 << (values.size - 1).bit_length()
        power = np.abs(np.fft.rfft(values, padded)) ** 2
        omega = np.arange(power.size) * (2.0 * math.pi / (padded * signal.dt))
        power[omega < 1.2 * slipping] = 0.0
        line = int(np.argmax(power))
        # of white noise, the power over n σ² is distributed as e^{−P}
        if power[line] > math.log(values.size / _CHANCE) * values.size * signal.noise**2:
            K_z = fit.m * float(omega[line]) ** 2 - fit.k
            if K_z > 0.0:
                yield 1.0 / math.sqrt(K_z)


def _moves(fit: RingFit) -> float:
    """From where to where the mass moves, m."""
    x = fit.phases(0)[:, PHASE_X]
    return float(np.ptp(x))


def _still(fit: RingFit, end: float) -> float:
    """The time from which on the mass sticks; `end` where it does not before."""
    start = fit.stretches[0].start
    return start + stuck_from(fit.phases(0, end), end - start)


def _without_ringing(fit: RingFit, part: Stretch) -> Stretch:
    """A stretch up to where the mass sticks, if no ringing shows after that: a K_z would follow from it by chance."""
    if any(True for _ in _ringing(fit, part)):
        return part
    end = _still(fit, part.end) + _AFTER * part.period
    if end >= part.end or not all(_rests(one, end, part) for one in part.signals):
        return part
    return part.cut(part.start, end)


def _rests(signal: Signal, since: float, part: Stretch) -> bool:
    """Whether the samples from a time on are a level and noise."""
    values = signal.values[signal.between(since, part.end)]
    width = max(1, round(part.period / (_PIECES * signal.dt)))
    n = values.size // width
    if n < 2:
        return True
    means = values[: n * width].reshape(n, width).mean(axis=1)
    excess = width * float(np.var(means)) / signal.noise**2
    return excess < 1.0 + _AGREES * math.sqrt(2.0 / n)


def _from_earlier(fit: RingFit, whole: Stretch, earliest: float) -> RingFit:
    """The fit with the start moved back for as long as the samples follow the motion."""
    one = fit.stretches[0]
    step = one.period / _BACK
    near = min(one.start + 1.5 * one.period, one.end)
    common = set(range(fit.point.size - STATE))
    here = fit_stretches([one.cut(one.start, near)], fit.k, fit.point, given=common, gain=_COARSE)
    start, doubted = one.start, 0
    points, gained = [fit.point], [(0, 0.0)]
    while here is not None and not doubted:
        start -= step
        if start < earliest - 0.5 * min(s.dt for s in one.signals):
            break
        trial = here.point.copy()
        trial[-STATE:] = _before(here.point, fit.k, step)
        part = whole.cut(start, near)
        there = fit_stretches([part], fit.k, trial, given=common, gain=_COARSE)
        doubted = _doubted(there, here, gained)
        if doubted and there is not None:  # the common unknowns may have been off
            here, there = (
                fit_stretches([part], fit.k, at, gain=_COARSE)
                for part, at in (
                    (whole.cut(start + step, one.end), here.point),
                    (whole.cut(start, one.end), there.point),
                )
            )
            doubted = _doubted(there, here, gained[:1])
            if doubted and here is not None:  # or the climb may have stopped in a side minimum
                again = here.point.copy()
                again[-STATE:] = _before(here.point, fit.k, step)
                other = fit_stretches([whole.cut(start, one.end)], fit.k, again, gain=_COARSE)
                if not (left := _doubted(other, here, gained[:1])):
                    there, doubted = other, left
            if not doubted and there is not None:
                gained = gained[:1]
                there = fit_stretches([part], fit.k, there.point, given=common, gain=_COARSE)
        if not doubted and there is not None and here is not None:
            points.append(there.point)
            new = there.residual.size - here.residual.size
            gained.append((new, there.chi_square - here.chi_square))
        here = there
    # what stopped it may have begun within the steps that are in doubt
    kept = max(0, len(points) - 1 - doubted)
    part = whole.cut(one.start - kept * step, one.end)
    return fit_stretches([part], fit.k, points[kept], gain=_COARSE) or fit


def _doubted(
    there: RingFit | None, here: RingFit | None, gained: Sequence[tuple[int, float]]
) -> int:
    """Number of steps back that are in doubt, 0 where the samples follow the motion, judged by the contribution of the
    last step, or of the last three, to χ².

    gained : samples and what they added to χ², of the steps before.
    """
    from scipy import special  # slow to import

    if there is None or here is None:
        return 1
    steps = [
        *gained,
        (there.residual.size - here.residual.size, there.chi_square - here.chi_square),
    ]
    for count in (1, _SEVERAL):
        new = sum(n for n, _ in steps[-count:])
        excess = math.fsum(chi_square for _, chi_square in steps[-count:])
        if new and special.chdtrc(new, max(excess, 0.0)) < _LEFT:
            return count
    return 0


def _before(point: Array, k: float, step: float) -> Array:
    """About the start state a step earlier: slipping backwards, or at the turn before."""
    F_k, c, _, m = point[: len(COMMON)].tolist()
    x, v, w = point[-STATE:].tolist()
    side = 1.0 if w >= 1.0 else -1.0
    n = 16
    h = step / n
    for _ in range(n):
        a = -(k * x + side * F_k + c * v) / m
        v_half = v - 0.5 * h * a
        if v_half * side < 0.0:  # it turned there, or was let go
            return np.array([x, 0.0, 1.0 - 0.5 * side])
        x -= h * v_half
        v = v_half - 0.5 * h * -(k * x + side * F_k + c * v_half) / m
    return np.array([x, v, w])
