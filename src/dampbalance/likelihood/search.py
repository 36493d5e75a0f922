"""The search for the oscillator of free decays: each by itself over a growing part of it, then all together.

At a turn p of a free motion that slips, ẋ = 0 and z = ±F_k/K_z. Its next turns follow from the swings before and after,

    D_{i+1} = e^{−βπ} D_i − 2(1 + e^{−βπ}) F_k/k,      β = ζ/√(1 − ζ²),

for several shares of friction in what the swing loses, and for a few stiffnesses of the contact. The closest of these
are climbed from over the first cycle, and the best fit follows the decay to its end. A mass at rest may ring on the
contact, and the spectral line of that ringing gives K_z. Then the start is moved back for as long as the samples follow
the motion: what held or pushed the mass before is left out.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from ..arrays import Array
from ..motion.events import PHASE_S, PHASE_X
from ..reading.bursts import Burst, Signal, bursts_of
from .decay import COMMON, STATE, Decay, RingFit, Samples, fit_decays, with_noise_of
from .minima import minima_of, ringing

_SHARES = (0.05, 0.35, 0.65, 0.95)  # of friction in what the swing loses
_STIFFNESSES = (4.0, 30.0, 300.0)  # of K_z/k
_MASSES = (0.85, 1.0, 1.15)  # relative to that of the period
_CLIMBED = 4  # starts
_FIRST = 1.0  # cycles that are fitted first
_GROWTH = 2.0  # of the fitted part from one climb to the next
_COARSE = 1e-2  # of half of χ², where a climb on the way ends
_PIECES = 12  # of a cycle, in which the mass is looked at for rest
_BACK = 24  # steps of a cycle in which the start moves back
_LEFT = 3e-4  # probability of what new samples add to χ²
_LOADS = (0.0, 0.5, 1.0, 1.5, 2.0)  # of w, where the contact may be loaded otherwise
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

    def fitted(burst: Burst, surest: RingFit | None) -> RingFit | None:
        """The fit of a burst, which lies between the decays before and after it."""
        before = (
            fit.decays[0].end for b, fit in fits.items() if b.turn < burst.turn and fit.adequate
        )
        after = (fit.decays[0].start for b, fit in fits.items() if b.turn > burst.turn)
        earliest, end = max(burst.earliest, *before, -math.inf), min(burst.end, *after, math.inf)
        whole = Decay(source, burst.turn, end, tuple(signals), burst.period)
        return _of_burst(whole, replace(burst, earliest=earliest, end=end), lead, k, surest)

    for burst in bursts:
        if (fit := fitted(burst, None)) is not None:
            fits[burst] = fit
    slipping = [fit for fit in fits.values() if fit.adequate and _turns(fit)]
    surest = max(slipping, key=lambda fit: fit.samples, default=None)
    for burst in bursts if surest is not None else ():
        if burst not in fits or not fits[burst].adequate:
            fit = fitted(burst, surest)
            if fit is not None and fit.adequate:
                fits[burst] = fit
    kept = {burst: fit for burst, fit in fits.items() if fit.adequate} or fits
    kept = {burst: fit for burst, fit in kept.items() if _turns(fit)} or kept
    return [kept[b] for b in bursts if b in kept], [b for b in bursts if b not in kept]


def _of_burst(
    whole: Decay, burst: Burst, lead: Signal, k: float, surest: RingFit | None
) -> RingFit | None:
    """The fit of a burst, from its release on; None where no oscillator moves as far as it does.

    surest : the fit of another burst, to start from.
    """
    fit = _grown(whole, burst, lead, k, surest)
    if fit is None:
        return None
    if fit.adequate:  # its residual gives the noise better than the samples alone
        fit = with_noise_of(fit)
        pairs = zip(whole.signals, fit.decays[0].signals, strict=True)
        signals = tuple(replace(one, noise=other.noise) for one, other in pairs)
        whole = replace(whole, signals=signals)
    fit = _or_lower(_from_earlier(fit, whole, burst.earliest))
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
    whole = _joined(fits)
    if whole is not None and not _of_one(whole, fits):
        whole = minima_of(whole, wide=len(fits) == 1)[0]
    if whole is None or len(fits) == 1 or _of_one(whole, fits):
        return whole, []
    handled = sorted((fit for fit in fits if _turns(fit) <= _MOST_TURNS), key=_turns)
    for count in range(1, len(fits)):
        for some in itertools.combinations(handled[: count + _SPARE], count):
            rest = [fit for fit in fits if fit not in some]
            fit = _joined(rest)
            if fit is not None and _of_one(fit, rest):
                return fit, [fit.decays[0] for fit in fits if fit in some]
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


def _joined(fits: Sequence[RingFit]) -> RingFit | None:
    """The fit of all decays: from the oscillator of each in turn, that of most samples first, until one is adequate."""
    decays, size = [fit.decays[0] for fit in fits], len(COMMON)
    offsets = np.zeros(1 + max(signal.offset for one in decays for signal in one.signals))
    for fit, one in zip(fits, decays, strict=True):
        places = [signal.offset for signal in one.signals]
        offsets[places] = fit.point[size:][places]
    rest = np.concatenate([offsets, *(fit.point[-STATE:] for fit in fits)])
    ends: list[RingFit | None] = []
    for fit in sorted(fits, key=lambda fit: -fit.samples):
        end = fit_decays(decays, fit.k, np.concatenate([fit.point[:size], rest]))
        if end is not None and end.adequate:
            return end
        ends.append(end)
    return _lowest(ends)


def _lowest(fits: Iterable[RingFit | None]) -> RingFit | None:
    """The first fit with the smallest χ²; None where there is none."""
    return min(filter(None, fits), key=lambda fit: fit.chi_square, default=None)


def _or_lower(fit: RingFit) -> RingFit:
    """The fit, or a lower minimum where its residual may be that of a side minimum."""
    return minima_of(fit)[0] if fit.doubtful else fit


def _refit(
    fit: RingFit, part: Decay, start: Array | None = None, given: Collection[int] = ()
) -> RingFit | None:
    """The fit of a part of a decay, from the point of a fit or from another start, as close as is needed on the way."""
    point = fit.point if start is None else start
    return fit_decays([part], fit.k, point, given=given, gain=_COARSE)


def _grown(
    whole: Decay, burst: Burst, lead: Signal, k: float, surest: RingFit | None
) -> RingFit | None:
    """The fit of a burst from its turn on."""
    end = min(burst.turn + _FIRST * burst.period, burst.end)
    part = whole.cut(burst.turn, end)
    if part.samples < _LEAST:
        return None
    starts = _starts(part, burst, lead, k)
    if surest is not None:
        starts[:, : len(COMMON)] = surest.point[: len(COMMON)]
    samples, w = Samples.of([part], k, starts.shape[1]), {starts.shape[1] - 1}
    rough = samples.climbs(starts, w, gain=1.0, most=3)[:_CLIMBED]
    fit = _lowest(fit_decays([part], k, one.point, given=w, gain=_COARSE) for one in rough)
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
    return fit and _or_lower(fit)


def _starts(part: Decay, burst: Burst, lead: Signal, k: float) -> Array:
    """Start points from the swings before and after the turn, (n, p)."""
    omega = 2.0 * math.pi / burst.period
    ahead = lead.between(burst.turn, min(burst.turn + 0.6 * burst.period, part.end))
    next_swing = min(float(np.ptp(ahead.values)) / omega**lead.order, burst.swing)
    lost = max(burst.swing - next_swing, 1e-3 * burst.swing)
    offsets = np.zeros(1 + max(signal.offset for signal in part.signals))
    for signal in part.signals:
        offsets[signal.offset] = signal.values.mean()
    starts = []
    for share, mass, stiffness in itertools.product(_SHARES, _MASSES, _STIFFNESSES):
        ratio = min(max(1.0 - (1.0 - share) * lost / burst.swing, 0.5), 0.9999)
        zeta = -math.log(ratio) / math.hypot(math.pi, math.log(ratio))
        friction = share * lost / 4.0
        m = mass * k / omega**2
        c, rho = 2.0 * zeta * math.sqrt(k * m), 1.0 / math.sqrt(stiffness * k)
        x = burst.side * (next_swing / (1.0 + ratio) + friction)
        starts.append((k * friction, c, rho, m, *offsets, x, 0.0, 1.0 + burst.side))
    return np.array(starts)


def _longer(fit: RingFit, part: Decay) -> RingFit | None:
    """The fit of a longer part, from a shorter one on, or from the contact on which it rings."""
    w = {fit.point.size - 1}
    part = _without_ringing(fit, part)
    best = _refit(fit, part, given=w)
    for K_z in _rings(best or fit, part):
        start = (best or fit).point.copy()
        start[COMMON.index("rho")] = K_z**-0.5
        best = _lowest((best, _refit(fit, part, start, w)))
    return best


def _rings(fit: RingFit, part: Decay) -> Iterator[float]:
    """K_z of the contact on which the mass at rest rings, where that shows."""
    # of white noise, the gain of a line is distributed as e^{−P}
    lines = ringing(fit, [part], 0.25 * part.period)[:1]
    return (K_z for K_z, gain in lines if gain > math.log(part.samples / _CHANCE))


def _without_ringing(fit: RingFit, part: Decay) -> Decay:
    """The part up to where the mass sticks, if no ringing shows after that: a K_z would follow from it by chance."""
    end = fit.decays[0].start + fit.sticks_from(0, part.end) + _AFTER * part.period
    rings = next(_rings(fit, part), None) is not None
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


def _until_disturbed(fit: RingFit, whole: Decay, end: float) -> RingFit:
    """The fit up to where the samples leave the motion, before `end`."""
    start, good = whole.start, fit.decays[0].end
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
    (one,) = fit.decays
    still = one.start + fit.sticks_from(0)
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


def _from_earlier(fit: RingFit, whole: Decay, earliest: float) -> RingFit:
    """The fit with the start moved back for as long as the samples follow the motion."""
    (one,) = fit.decays
    earliest -= 0.5 * min(signal.dt for signal in one.signals)
    step = one.period / _BACK
    fits, start = [fit], one.start - step
    while start >= earliest:
        here, part = fits[-1], whole.cut(start, one.end)
        before = _before(here.point, fit.k, step)
        longer = _refit(here, part, before)
        # the climb may have stopped in a side minimum
        for w in _LOADS if _doubted(fits, longer) else ():
            before[-1] = w
            longer = _lowest((longer, _refit(here, part, before)))
        if doubted := _doubted(fits, longer):
            # what stopped it may have begun within the steps that are in doubt
            return fits[max(0, len(fits) - 1 - doubted)]
        fits += [longer] if longer is not None else []
        start -= step
    return fits[-1]


def _doubted(fits: Sequence[RingFit], longer: RingFit | None) -> int:
    """Number of steps back that are in doubt, 0 where the samples follow the motion, judged by the contribution of the
    last step, or of the last three, to χ²."""
    from scipy import special  # slow to import

    if longer is None:
        return 1
    for count in (1, _SEVERAL):
        here = fits[-count:][0]
        new, excess = longer.samples - here.samples, longer.chi_square - here.chi_square
        if new and special.chdtrc(new, max(excess, 0.0)) < _LEFT:
            return count
    return 0


def _before(point: Array, k: float, step: float) -> Array:
    """The point with about the start state a step earlier: slipping backwards, and from the other side at a turn."""
    F_k, c, _, m = point[: len(COMMON)].tolist()
    x, v, w = point[-STATE:].tolist()
    side = math.copysign(1.0, v if v != 0.0 else w - 1.0)
    n = 16
    h = step / n
    for _ in range(n):
        v_half = v + 0.5 * h * (k * x + side * F_k + c * v) / m
        if v_half * side < 0.0:  # it turned there, or was let go
            side, v, v_half = -side, 0.0, 0.0
            w = 1.0 + side
        x -= h * v_half
        v = v_half + 0.5 * h * (k * x + side * F_k + c * v_half) / m
    return np.concatenate([point[:-STATE], [x, v, w]])
