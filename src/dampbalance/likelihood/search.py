"""The search for the oscillator of free decays: each by itself over a growing part of it, then all together.

At a turn p of a free motion that slips, ẋ = 0 and z = ±F_k/K_z. Its next turns follow from the swings before and after,

    D_{i+1} = e^{−βπ} D_i − 2(1 + e^{−βπ}) F_k/k,      β = ζ/√(1 − ζ²),

for several shares of friction in what the swing loses, and for a few stiffnesses of the contact. The closest of these
are climbed from over the first cycle, and the fit follows the decay to its end. A mass at rest may ring on the contact,
and the spectral line of that ringing gives K_z. Then the start is moved back for as long as the samples follow the
motion: what held or pushed the mass before is left out.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from ..arrays import Array
from ..motion.events import PHASE_S, PHASE_V, PHASE_X
from ..reading.bursts import Burst, Signal, bursts_of
from .decay import COMMON, STATE, Decay, RingFit, fit_decays, samples_of, with_noise_of
from .minima import minima_of

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
_SWINGS = 0.25  # of a cycle, for which a decay goes on after its turn
_LEAST = 4 * (len(COMMON) + STATE)  # samples of a decay
_PART = 0.1  # of the swing of a burst, that its motion has at least
_DISTURBED = 0.02  # probability of a residual after which a burst ends before the next one
_ALIKE = 1.5  # χ² per sample of a fit that needs no other start
_ONE = 1e-3  # probability of what one oscillator for all decays adds to χ²
_SPARE = 3  # bursts that may be left out instead of those that slip least
_MOST_TURNS = 4  # half cycles that slip, of a burst that may be the work of a hand


def separate_fits(
    source: str, signals: Sequence[Signal], k: float
) -> tuple[list[RingFit], list[Burst]]:
    """A fit of each free decay in the channels of a record by itself, in their order, and the bursts that no oscillator
    fits or in which nothing slips.

    source : of the record.   signals : its channels, their offsets numbered through all records.   k : N/m.
    Raises NoDecay.
    """
    lead = max(signals, key=lambda one: float(np.ptp(one.values)) / one.noise)
    bursts = bursts_of(lead)
    fits: dict[Burst, RingFit] = {}

    def since(burst: Burst) -> float:
        """The time before which a burst cannot have begun: the one before it lasts until then."""
        ends = (
            fit.decays[0].end for b, fit in fits.items() if b.turn < burst.turn and fit.adequate
        )
        return max(burst.earliest, *ends, -math.inf)

    for burst in bursts:
        whole = Decay(source, burst.turn, burst.end, tuple(signals), burst.period)
        fit = _of_burst(whole, burst, since(burst), lead, k)
        if fit is not None:
            fits[burst] = fit
    slipping = [fit for fit in fits.values() if fit.adequate and _turns(fit)]
    surest = max(slipping, key=lambda fit: fit.decays[0].samples, default=None)
    for burst in bursts if surest is not None else ():
        if burst not in fits or not fits[burst].adequate:  # from the oscillator of the surest
            starts = (fit.decays[0].start for b, fit in fits.items() if b.turn > burst.turn)
            end = min(burst.end, *starts, math.inf)
            whole = Decay(source, burst.turn, end, tuple(signals), burst.period)
            fit = _of_burst(whole, replace(burst, end=end), since(burst), lead, k, surest)
            if fit is not None and fit.adequate:
                fits[burst] = fit
    kept = {burst: fit for burst, fit in fits.items() if fit.adequate} or fits
    kept = {burst: fit for burst, fit in kept.items() if _turns(fit)} or kept
    return [kept[b] for b in bursts if b in kept], [b for b in bursts if b not in kept]


def _of_burst(
    whole: Decay, burst: Burst, since: float, lead: Signal, k: float, known: RingFit | None = None
) -> RingFit | None:
    """The fit of a burst, from its release on; None where no oscillator moves as far as it does.

    since : s, before which it cannot have begun.   known : the fit of another burst, to start from.
    """
    fit = _grown(whole, burst, lead, k, known)
    if fit is None:
        return None
    if fit.adequate:  # its residual gives the noise better than the samples alone
        fit = with_noise_of(fit)
        pairs = zip(whole.signals, fit.decays[0].signals, strict=True)
        signals = tuple(replace(one, noise=other.noise) for one, other in pairs)
        whole = replace(whole, signals=signals)
    fit = refit_from_other_starts(_from_earlier(fit, whole, since))
    if not burst.last:
        fit = _until_grasped(fit)
    # what ends right after the turn, or before it, is the rest of the burst ahead
    if fit.samples < _LEAST or fit.decays[0].end < burst.turn + _SWINGS * burst.period:
        return None
    # else the swing was not that of a free motion
    return fit if float(np.ptp(fit.phases(0)[:, PHASE_X])) > _PART * burst.swing else None


def fit_all(fits: Sequence[RingFit]) -> tuple[RingFit | None, list[Decay]]:
    """One oscillator for the decays with these separate fits, and what is not a decay of it.

    A hand that moves the mass from one place to another can look like half a cycle of another oscillator. Where no
    oscillator fits all decays about as well as each has its own, as few as possible are left out, those that slip least
    first, if one then fits the rest.
    """
    offsets = 1 + max(one.offset for fit in fits for one in fit.decays[0].signals)
    whole = _joined(fits, offsets)
    if whole is not None and not whole.adequate:
        others = [_joined(fits, offsets, fit.point[: len(COMMON)]) for fit in fits]
        whole = _nearest((whole, *others))
    if whole is None or _of_one(whole, fits):
        return whole, []
    whole = minima_of(whole, wide=len(fits) == 1)[0]
    if len(fits) == 1 or _of_one(whole, fits):
        return whole, []
    turns = [_turns(fit) for fit in fits]
    order = np.argsort(turns, kind="stable").tolist()
    for count in range(1, len(fits)):
        if turns[order[count - 1]] > _MOST_TURNS:
            break
        for some in itertools.combinations(order[: count + _SPARE], count):
            if any(turns[i] > _MOST_TURNS for i in some):
                continue
            rest = [fit for i, fit in enumerate(fits) if i not in some]
            fit = _joined(rest, offsets)
            if fit is not None and _of_one(fit, rest):
                return fit, [fits[i].decays[0] for i in sorted(some)]
    return whole if whole.adequate else minima_of(whole)[0], []


def _of_one(whole: RingFit, fits: Sequence[RingFit]) -> bool:
    """Whether the decays are those of one oscillator: what χ² of one for all lies above those of one for each is within
    what as many unknowns fewer leave, and its residual is noise."""
    from scipy import special  # slow to import

    fewer = sum(np.count_nonzero(fit.free) for fit in fits) - np.count_nonzero(whole.free)
    excess = whole.chi_square - math.fsum(fit.chi_square for fit in fits)
    same = fewer <= 0 or special.chdtrc(fewer, max(excess, 0.0)) > _ONE
    return whole.adequate and bool(same)


def _turns(fit: RingFit) -> int:
    """Number of phases in which the mass of a separate fit slips."""
    return int(np.count_nonzero(fit.phases(0)[:, PHASE_S]))


def _joined(fits: Sequence[RingFit], offsets: int, common: Array | None = None) -> RingFit | None:
    """The fit of all decays, started from the separate ones: the common unknowns are averaged, weighted by their
    information.

    offsets : how many there are in all.   common : common unknowns of the start, instead of the weighted mean.
    """
    size = len(COMMON)
    information, right = np.zeros((size, size)), np.zeros(size)
    levels, weights = np.zeros(offsets), np.zeros(offsets)
    k, m = fits[0].k, fits[0].m
    unit = np.array([fits[0].F_k, 1e-2 * math.sqrt(k * m), 1e-1 / math.sqrt(k), m])
    for fit in fits:
        scaled = fit.covariance[:size, :size] / np.outer(unit, unit)
        one = np.linalg.pinv(scaled, rcond=1e-12, hermitian=True)
        information += one
        right += one @ (fit.point[:size] / unit)
        for signal in fit.decays[0].signals:
            levels[signal.offset] += fit.point[size + signal.offset] * fit.decays[0].samples
            weights[signal.offset] += fit.decays[0].samples
    if common is None:
        common = unit * np.linalg.lstsq(information, right)[0]
        if not (common > 0.0).all():
            common = max(fits, key=lambda fit: fit.decays[0].samples).point[:size]
    levels /= np.maximum(weights, 1.0)
    start = np.concatenate([common, levels, *(fit.point[-STATE:] for fit in fits)])
    return fit_decays([fit.decays[0] for fit in fits], k, start)


def _nearest(fits: Iterable[RingFit | None]) -> RingFit | None:
    """The first fit with the smallest χ²; None where there is none."""
    return min(filter(None, fits), key=lambda fit: fit.chi_square, default=None)


def _refit(
    fit: RingFit, part: Decay, start: Array | None = None, given: Collection[int] = ()
) -> RingFit | None:
    """The fit of a part of a decay, from the point of a fit or from another start, as close as is needed on the way."""
    point = fit.point if start is None else start
    return fit_decays([part], fit.k, point, given=given, gain=_COARSE)


def _grown(
    whole: Decay, burst: Burst, lead: Signal, k: float, known: RingFit | None
) -> RingFit | None:
    """The fit of a burst from its turn on."""
    end = min(burst.turn + _FIRST * burst.period, burst.end)
    part = whole.cut(burst.turn, end)
    if part.samples < _LEAST:
        return None
    reached: list[RingFit | None] = []
    starts = _candidates(part, burst, lead, k)[:_CLIMBED]
    if known is not None:
        starts = [np.concatenate([known.point[: len(COMMON)], at[len(COMMON) :]]) for at in starts]
    for start in starts:
        last = fit_decays([part], k, start, given={start.size - 1}, gain=_COARSE)
        reached.append(last)
        if last is not None and last.chi_square < _ALIKE * part.samples:
            break
    fit = _nearest(reached)
    if fit is not None:
        fit = _longer(fit, part)
    while fit is not None and end < burst.end:
        end = min(burst.turn + _GROWTH * (end - burst.turn), burst.end)
        if burst.end - end < 0.25 * burst.period:
            end = burst.end
        longer = _longer(fit, whole.cut(burst.turn, end))
        if longer is None:
            break
        if not burst.last and longer.whiteness.chance < _DISTURBED <= fit.whiteness.chance:
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
    best = [fit]
    for share in _SHARES if loss > 0.0 else ():
        for w in (fit.point[-1],) if given or len(fit.decays) > 1 else (0.0, 2.0):
            start = fit.point.copy()
            start[0], start[1] = share * loss / travel, (1.0 - share) * loss / (ratio * travel)
            start[-1] = w
            other = fit_decays(fit.decays, fit.k, start, given=given, gain=_COARSE)
            best += [other] if other is not None else []
    return min(best, key=lambda one: one.chi_square)


def _longer(fit: RingFit, part: Decay) -> RingFit | None:
    """The fit of a longer part, from a shorter one on."""
    w = fit.point.size - 1
    part = _without_ringing(fit, part)
    best = _refit(fit, part, given={w})
    for rho in _ringing(best or fit, part):
        start = (best or fit).point.copy()
        start[2] = rho
        best = _nearest((best, _refit(fit, part, start, {w})))
    return best


def _until_disturbed(fit: RingFit, whole: Decay, end: float) -> RingFit:
    """The fit up to where the samples leave the motion, before `end`."""
    start, good = whole.start, fit.decays[0].end
    while end - good > 0.1 * whole.period:
        middle = 0.5 * (good + end)
        longer = _longer(fit, whole.cut(start, middle))
        if longer is not None and longer.whiteness.chance >= _DISTURBED:
            fit, good = longer, middle
        else:
            end = middle
    if good - start > 2.0 * whole.period:  # the disturbance may show late
        fit = _longer(fit, whole.cut(start, good - 0.5 * whole.period)) or fit
    return fit


def _until_grasped(fit: RingFit) -> RingFit:
    """The fit, truncated where the ringing mass is caught before the next release."""
    (one,) = fit.decays
    still = _still(fit, one.end)
    ends = []
    for _, signal, residual in fit.residuals():
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
    return _refit(fit, one.cut(one.start, min(ends))) or fit


def _candidates(part: Decay, burst: Burst, lead: Signal, k: float) -> list[Array]:
    """Start points from the swings before and after the turn, the closest first."""
    omega = 2.0 * math.pi / burst.period
    ahead = lead.between(burst.turn, min(burst.turn + 0.6 * burst.period, part.end))
    next_swing = min(float(np.ptp(ahead.values)) / omega**lead.order, burst.swing)
    lost = max(burst.swing - next_swing, 1e-3 * burst.swing)
    offsets = np.zeros(1 + max(signal.offset for signal in part.signals))
    candidates = []
    for share, mass, stiffness in itertools.product(_SHARES, _MASSES, _STIFFNESSES):
        ratio = min(max(1.0 - (1.0 - share) * lost / burst.swing, 0.5), 0.9999)
        zeta = -math.log(ratio) / math.hypot(math.pi, math.log(ratio))
        friction = share * lost / 4.0
        m = mass * k / omega**2
        c, rho = 2.0 * zeta * math.sqrt(k * m), 1.0 / math.sqrt(stiffness * k)
        x = burst.side * (next_swing / (1.0 + ratio) + friction)
        state = np.array([x, 0.0, 1.0 + burst.side])
        start = np.concatenate([(k * friction, c, rho, m), offsets, state])
        try:
            model = samples_of(start, state, k, part)
        except ValueError:
            continue
        misfit, at = 0.0, 0
        for signal in part.signals:
            off = signal.values - model[at : at + signal.t.size]
            at += signal.t.size
            start[len(COMMON) + signal.offset] = off.mean()
            misfit += float(np.var(off)) * signal.t.size / signal.noise**2
        candidates.append((misfit, start))
    candidates.sort(key=lambda one: one[0])
    return [start for _, start in candidates]


def _ringing(fit: RingFit, part: Decay) -> Iterator[float]:
    """ρ of the contact on which the mass at rest rings, where that shows: K_z = mΩ² − k."""
    still = _still(fit, part.end)
    slipping = math.sqrt(fit.k / fit.m)
    for signal in part.signals:
        values = signal.between(still + 0.25 * part.period, part.end).values
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


def _still(fit: RingFit, end: float) -> float:
    """The time from which on the mass sticks; `end` where it does not before."""
    return min(fit.decays[0].start + fit.sticks_from(0, end), end)


def _without_ringing(fit: RingFit, part: Decay) -> Decay:
    """The part up to where the mass sticks, if no ringing shows after that: a K_z would follow from it by chance."""
    end = _still(fit, part.end) + _AFTER * part.period
    rings = next(_ringing(fit, part), None) is not None
    if rings or end >= part.end or not all(_rests(one, end, part) for one in part.signals):
        return part
    return part.cut(part.start, end)


def _rests(signal: Signal, since: float, part: Decay) -> bool:
    """Whether the samples from a time on are a level and noise."""
    values = signal.between(since, part.end).values
    width = max(1, round(part.period / (_PIECES * signal.dt)))
    n = values.size // width
    if n < 2:
        return True
    means = values[: n * width].reshape(n, width).mean(axis=1)
    excess = width * float(np.var(means)) / signal.noise**2
    return excess < 1.0 + _AGREES * math.sqrt(2.0 / n)


def _from_earlier(fit: RingFit, whole: Decay, earliest: float) -> RingFit:
    """The fit with the start moved back for as long as the samples follow the motion."""
    (one,) = fit.decays
    step = one.period / _BACK
    near = min(one.start + 1.5 * one.period, one.end)
    common = set(range(fit.point.size - STATE))
    here = _refit(fit, one.cut(one.start, near), given=common)
    start, doubted = one.start, 0
    points, gained = [fit.point], [(0, 0.0)]
    while here is not None and not doubted:
        start -= step
        if start < earliest - 0.5 * min(s.dt for s in one.signals):
            break
        part = whole.cut(start, near)
        there = _refit(here, part, _before(here.point, fit.k, step), common)
        doubted = _doubted(there, here, gained)
        if doubted and there is not None:  # the common unknowns may have been off
            here = _refit(here, whole.cut(start + step, one.end))
            there = _refit(there, whole.cut(start, one.end))
            doubted = _doubted(there, here, gained[:1])
            if doubted and here is not None:  # or the climb may have stopped in a side minimum
                again = _before(here.point, fit.k, step)
                other = _refit(here, whole.cut(start, one.end), again)
                if not (left := _doubted(other, here, gained[:1])):
                    there, doubted = other, left
            if not doubted and there is not None:
                gained = gained[:1]
                there = _refit(there, part, given=common)
        if not doubted and there is not None and here is not None:
            points.append(there.point)
            gained.append(_gain(there, here))
        here = there
    # what stopped it may have begun within the steps that are in doubt
    kept = max(0, len(points) - 1 - doubted)
    return _refit(fit, whole.cut(one.start - kept * step, one.end), points[kept]) or fit


def _gain(there: RingFit, here: RingFit) -> tuple[int, float]:
    """Samples of a step back, and what they add to χ²."""
    return there.samples - here.samples, there.chi_square - here.chi_square


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
    steps = [*gained, _gain(there, here)]
    for count in (1, _SEVERAL):
        new = sum(n for n, _ in steps[-count:])
        excess = math.fsum(chi_square for _, chi_square in steps[-count:])
        if new and special.chdtrc(new, max(excess, 0.0)) < _LEFT:
            return count
    return 0


def _before(point: Array, k: float, step: float) -> Array:
    """The point with about the start state a step earlier: slipping backwards, or at the turn before."""
    F_k, c, _, m = point[: len(COMMON)].tolist()
    x, v, w = point[-STATE:].tolist()
    side = 1.0 if w >= 1.0 else -1.0
    n = 16
    h = step / n
    for _ in range(n):
        a = -(k * x + side * F_k + c * v) / m
        v_half = v - 0.5 * h * a
        if v_half * side < 0.0:  # it turned there, or was let go
            v, w = 0.0, 1.0 - 0.5 * side
            break
        x -= h * v_half
        v = v_half - 0.5 * h * -(k * x + side * F_k + c * v_half) / m
    return np.concatenate([point[:-STATE], [x, v, w]])
