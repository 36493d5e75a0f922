"""The search for the oscillator of free decays: each by itself over a growing part of it, then all together.

At a turn p of a free motion that slips, ẋ = 0 and z = ±F_k/K_z. Its next turns follow from the swings before and after,

    D_{i+1} = e^{−βπ} D_i − 2(1 + e^{−βπ}) F_k/k,      β = ζ/√(1 − ζ²),

for several shares of friction in what the swing loses, and for a few stiffnesses of the contact. The closest of these
are climbed from over the first cycle, and the best fit follows the decay to its end. A mass at rest may ring on the
contact, and the spectral line of that ringing gives K_z. Then the start is moved back for as long as the samples follow
the motion: what held or pushed the mass before is left out.

The ringing makes χ² oscillate along K_z: a fit whose ringing is a cycle off over the record is a side minimum. All
minima that matter are searched for in four stages, each of which passes on what is lowest: starts, from a grid of
losses, shares of friction and stiffnesses, from lines of the spectrum after the mass came to rest, and along K_z and
F_k; climbs on thinned samples; climbs on all samples, with starts on the other side of kinks of χ², where an event
appears or vanishes; and climbs to the end. A minimum that is found lower is searched around again.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import replace
from typing import TypeVar

import numpy as np
from scipy import special

from ..arrays import Array
from ..motion.events import PHASE_S, PHASE_V, PHASE_X
from ..motion.unknowns import F_K, OSCILLATOR_UNKNOWNS, RHO, C, M
from ..signals.bursts import Burst, Signal, bursts_of
from .climb import Climb
from .decay import (
    STATE,
    Decay,
    DecaySamples,
    RingFit,
    fit_decays,
    with_noise_of,
)

_SHARES_OF_LOSS = (0.05, 0.35, 0.65, 0.95)  # of friction in what the swing, or the motion, loses
_FIRST_STIFFNESSES = (4.0, 30.0, 300.0)  # of K_z/k
_MASSES = (0.85, 1.0, 1.15)  # relative to that of the period
_CLIMBED, _GOOD_START = 4, 1.5  # starts, until χ² per sample is below that
_FIRST = 1.0  # cycles that are fitted first, or more where these have too few samples
_GROWTH = 2.0  # of the fitted part from one climb to the next
_GAIN_ON_THE_WAY = 1e-2  # of half of χ², where a climb on the way ends
_PIECES = 12  # of a cycle, in which the mass is looked at for rest
_BACK = 24  # steps of a cycle in which the start moves back
P_STEP_BACK = 3e-4  # that new samples add as much to χ² by chance
_PRELOADS = (
    0.0,
    0.5,
    1.0,
    1.5,
    2.0,
)  # of the contact spring, tried where it may be loaded otherwise
_SEVERAL = 3  # steps back that are looked at together
_DEVIATIONS_AT_REST = 4.0  # standard deviations of the scatter of a mass at rest
P_LINE_IN_NOISE = 1e-4  # probability of a line of the spectrum in noise
_AFTER = 0.02  # of a cycle, that is kept where the mass sticks and does not ring
_FEWEST_AT_REST = 16  # samples of a mass at rest, at the least
_GRASPED = 4.0  # of χ², beyond what the choice of an instant makes
_DECAY_AFTER_TURN = 0.25  # of a cycle, for which a decay goes on after its turn
_FEWEST_SAMPLES = 4 * (len(OSCILLATOR_UNKNOWNS) + STATE)  # samples of a decay
_LEAST_SWING = 0.1  # of the swing of a burst, that its motion has at least
P_DISTURBED = 0.02  # probability of a residual after which a burst ends before the next one
P_ONE_OSCILLATOR = (
    1e-3  # that one oscillator, or friction force, for all decays adds as much to χ² by chance
)
_MOST_HALF_CYCLES = 4  # half cycles that slip, of a burst that may be the work of a hand

# of the search for all minima
_LOSSES = tuple(np.geomspace(0.75, 1.4, 12).tolist())  # relative to that of the fit
_FINER = tuple(np.linspace(0.1, 1.0, 16).tolist())  # shares of friction next to these
_STIFFER = (3.0, 8.0, 20.0, 50.0, 120.0, 300.0, 1000.0)  # of K_z/k
_FRICTIONS = np.geomspace(0.75, 1.33, 30)  # relative to that of the fit
_OTHER_MASSES = (0.82, 0.9, 0.95, 1.05, 1.1, 1.2)  # relative, where the fit is not adequate
_SCANNED = tuple(np.geomspace(0.5, 1e5, 45).tolist())  # of K_z/k, the last as good as rigid
_PRELOAD_APART = 0.2  # how far off another start is
_ERRORS_ASIDE = 1.5  # standard errors
_LINES = 24  # of the spectrum of the ringing
_LESS_LIKELY = (
    10.0  # of the likelihood's logarithm: lines that fall so far behind the first are left out
)
_THINNED = 1500  # samples, about, of a thinned record
_THIN_STARTS, _POLISHED = 20, 12  # starts that are climbed from, on thinned samples and on all
_KEPT_ABOVE = 30.0  # of χ²: minima that are kept
_SAME_MINIMUM = 1.0  # standard errors: two climbs that end so close ended in one minimum
_LOWER_MINIMUM = 0.05  # of χ²: what another minimum must be lower by to be searched around again
_ROUNDS = 6

End = TypeVar("End", RingFit, Climb)


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
    if (
        fit.samples < _FEWEST_SAMPLES
        or fit.decays[0].end < burst.turn + _DECAY_AFTER_TURN * burst.period
    ):
        return None
    # else the swing was not that of a free motion
    return fit if float(np.ptp(fit.phases(0)[:, PHASE_X])) > _LEAST_SWING * burst.swing else None


def fit_all(fits: Sequence[RingFit]) -> tuple[RingFit | None, list[Decay]]:
    """One oscillator for the decays with these separate fits, and what is no decay at all.

    The decays share c, K_z and m, and F_k unless forces of their own are likelier by more than chance. A hand that
    moves the mass from one place to another can look like half a cycle of another oscillator: what slips in a few half
    cycles only is left out where no friction force whatever makes it a motion of the oscillator of the others.
    """
    whole = _of_all(fits)
    if whole is None or len(fits) == 1 or _same(whole, fits):
        return whole, []
    order = sorted(fits, key=lambda fit: (-_turns(fit), -fit.samples))
    kept = [fit for fit in order if _turns(fit) > _MOST_HALF_CYCLES] or order[:1]
    here = _of_all(kept)
    for fit in order[len(kept) :]:
        more = _of_all([*kept, fit])
        if here is None or (more is not None and _same(more, [here, fit])):
            kept, here = [*kept, fit], more
    left_out = [fit.decays[0] for fit in fits if fit not in kept]
    if left_out:
        whole = _of_all([fit for fit in fits if fit in kept])
    return whole if whole is None or whole.adequate else minima_of(whole)[0], left_out


def _of_all(fits: Sequence[RingFit]) -> RingFit | None:
    """The fit of all decays, with a friction force for each where the likelihood asks for it."""

    def fitted(own_frictions: bool) -> RingFit | None:
        whole = _fitted_together(fits, own_frictions=own_frictions)
        if whole is None or (whole.adequate and _same(whole, fits)):
            return whole
        return minima_of(whole, wide=len(fits) == 1)[0]

    whole = fitted(own_frictions=False)
    if whole is None or len(fits) == 1:
        return whole
    several = fitted(own_frictions=True)
    return whole if several is None or _same(whole, [several]) else several


def _same(whole: RingFit, parts: Sequence[RingFit]) -> bool:
    """Whether the unknowns that a fit has less than fits of its parts are not missed: its χ² lies above theirs by no
    more than chance makes of as many, in the noise that the parts leave."""
    fewer = sum(np.count_nonzero(fit.free) for fit in parts) - np.count_nonzero(whole.free)
    excess = whole.chi_square - math.fsum(fit.chi_square for fit in parts)
    noise = max((fit.misfit for fit in parts if not fit.adequate), default=1.0)
    return bool(fewer <= 0 or special.chdtrc(fewer, max(excess, 0.0) / noise) > P_ONE_OSCILLATOR)


def _turns(fit: RingFit) -> int:
    """Number of phases in which the mass of a separate fit slips."""
    return int(np.count_nonzero(fit.phases(0)[:, PHASE_S]))


def _fitted_together(fits: Sequence[RingFit], *, own_frictions: bool = False) -> RingFit | None:
    """The fit of all decays, with one friction force or one for each: from the oscillator of each in turn, that of most
    samples first, until one is adequate."""
    size = len(OSCILLATOR_UNKNOWNS)
    decays = [replace(fit.decays[0], friction=i * own_frictions) for i, fit in enumerate(fits)]
    offsets = np.zeros(1 + max(signal.offset for one in decays for signal in one.signals))
    for fit, one in zip(fits, decays, strict=True):
        places = [signal.offset for signal in one.signals]
        offsets[places] = fit.point[size:][places]
    frictions = [fit.F_k for fit in fits[1:] if own_frictions]
    rest = np.concatenate([offsets, frictions, *(fit.point[-STATE:] for fit in fits)])
    ends: list[RingFit | None] = []
    for fit in sorted(fits, key=lambda fit: -fit.samples):
        start = np.concatenate([fit.point[:size], rest])
        if own_frictions:
            start[F_K] = fits[0].F_k
        end = fit_decays(decays, fit.k, start)
        if end is not None and end.adequate:
            return end
        ends.append(end)
    return _lowest(ends)


def _lowest(fits: Iterable[RingFit | None]) -> RingFit | None:
    """The first fit with the smallest χ²; None where there is none."""
    return min(filter(None, fits), key=lambda fit: fit.chi_square, default=None)


def _or_lower(fit: RingFit) -> RingFit:
    """The fit, or a lower minimum where its residual may be that of a side minimum."""
    return minima_of(fit, wide=False)[0] if fit.doubtful else fit


def _refit(
    fit: RingFit, part: Decay, start: Array | None = None, given: Collection[int] = ()
) -> RingFit | None:
    """The fit of a part of a decay, from the point of a fit or from another start, as close as is needed on the way."""
    point = fit.point if start is None else start
    return fit_decays([part], fit.k, point, given=given, gain=_GAIN_ON_THE_WAY)


def _grown(
    whole: Decay, burst: Burst, lead: Signal, k: float, surest: RingFit | None
) -> RingFit | None:
    """The fit of a burst from its turn on."""
    enough = (_FEWEST_SAMPLES + 1) / math.fsum(1.0 / signal.dt for signal in whole.signals)
    end = min(burst.turn + max(_FIRST * burst.period, enough), burst.end)
    part = whole.cut(burst.turn, end)
    if part.samples < _FEWEST_SAMPLES:
        return None
    starts = _starts(part, burst, lead, k)
    if surest is not None:
        starts[:, : len(OSCILLATOR_UNKNOWNS)] = surest.point[: len(OSCILLATOR_UNKNOWNS)]
    samples, p = DecaySamples.of([part], k, starts.shape[1]), starts.shape[1]
    oscillator_and_state = {*range(len(OSCILLATOR_UNKNOWNS)), *range(p - STATE, p)}
    fit = None
    for one in samples.climbs(starts, oscillator_and_state, gain=0.0, most=2)[:_CLIMBED]:
        other = fit_decays([part], k, one.point, given={p - 1}, gain=_GAIN_ON_THE_WAY)
        fit = _lowest((fit, other))
        if fit is not None and fit.chi_square < _GOOD_START * part.samples:
            break
    good, bad = end, math.inf  # until where the samples follow the motion, and from where on not
    while fit is not None and good < burst.end and bad - good > 0.1 * burst.period:
        end = min(burst.turn + _GROWTH * (good - burst.turn), burst.end)
        if burst.end - end < 0.25 * burst.period:
            end = burst.end
        end = min(end, 0.5 * (good + bad))
        longer = _longer(fit, whole.cut(burst.turn, end))
        # something else may move the mass before the next burst
        if longer is None or (not burst.last and longer.chance < P_DISTURBED <= fit.chance):
            bad = end
        else:
            fit, good = longer, end
    if fit is not None and math.isfinite(bad) and good - burst.turn > 2.0 * burst.period:
        # what disturbs it may show late
        fit = _longer(fit, whole.cut(burst.turn, good - 0.5 * burst.period)) or fit
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
    for share, mass, stiffness in itertools.product(_SHARES_OF_LOSS, _MASSES, _FIRST_STIFFNESSES):
        ratio = min(max(1.0 - (1.0 - share) * lost / burst.swing, 0.5), 0.9999)
        zeta = -math.log(ratio) / math.hypot(math.pi, math.log(ratio))
        friction = share * lost / 4.0
        m = mass * k / omega**2
        c, rho = 2.0 * zeta * math.sqrt(k * m), 1.0 / math.sqrt(stiffness * k)
        x = burst.side * (next_swing / (1.0 + ratio) + friction)
        starts.append((k * friction, c, rho, m, *offsets, x, 0.0, 1.0 + burst.side))
    return np.array(starts)


def _longer(fit: RingFit, part: Decay) -> RingFit | None:
    """The fit of a longer part, from a shorter one on, or from the contact on which it rings; None where the mass comes
    to rest after too few samples."""
    preload = {fit.point.size - 1}
    part = _without_ringing(fit, part)
    if part.samples < _FEWEST_SAMPLES:
        return None
    best = _refit(fit, part, given=preload)
    for K_z in _rings(best or fit, part):
        start = (best or fit).point.copy()
        start[RHO] = K_z**-0.5
        best = _lowest((best, _refit(fit, part, start, preload)))
    return best


def _rings(fit: RingFit, part: Decay) -> Iterator[float]:
    """K_z of the contact on which the mass at rest rings, where that shows."""
    # of white noise, the gain of a line is distributed as e^{−P}
    lines = ringing(fit, [part], 0.25 * part.period)[:1]
    return (K_z for K_z, gain in lines if gain > math.log(part.samples / P_LINE_IN_NOISE))


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
    return excess < 1.0 + _DEVIATIONS_AT_REST * math.sqrt(2.0 / n)


def _until_grasped(fit: RingFit) -> RingFit:
    """The fit, truncated where the ringing mass is caught before the next release."""
    (one,) = fit.decays
    still = one.start + fit.sticks_from(0)
    ends = []
    for _, signal, residual in fit.residuals():
        first = int(np.searchsorted(signal.t, still))
        tail, off = signal.values[first:], residual[first:]
        if tail.size < _FEWEST_AT_REST:
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
        for preload in _PRELOADS if _doubted(fits, longer) else ():
            before[-1] = preload
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
    if longer is None:
        return 1
    for count in (1, _SEVERAL):
        here = fits[-count:][0]
        new, excess = longer.samples - here.samples, longer.chi_square - here.chi_square
        if new and special.chdtrc(new, max(excess, 0.0)) < P_STEP_BACK:
            return count
    return 0


def _before(point: Array, k: float, step: float) -> Array:
    """The point with about the start state a step earlier: slipping backwards, and from the other side at a turn."""
    F_k, c, _, m = point[: len(OSCILLATOR_UNKNOWNS)].tolist()
    x, v, preload = point[-STATE:].tolist()
    side = math.copysign(1.0, v if v != 0.0 else preload - 1.0)
    n = 16
    h = step / n
    for _ in range(n):
        v_half = v + 0.5 * h * (k * x + side * F_k + c * v) / m
        if v_half * side < 0.0:  # it turned there, or was let go
            side, v, v_half = -side, 0.0, 0.0
            preload = 1.0 + side
        x -= h * v_half
        v = v_half + 0.5 * h * (k * x + side * F_k + c * v_half) / m
    return np.concatenate([point[:-STATE], [x, v, preload]])


def minima_of(fit: RingFit, *, wide: bool = True) -> list[RingFit]:
    """The minima of χ² that a search finds, the lowest first, up to 30 above it; `fit` is where it starts.

    wide : whether to search over the loss of energy as well, and on around what is found until nothing lower is.
    """
    thin = [_thinned(one, _THINNED // len(fit.decays)) for one in fit.decays]
    minima = [fit]
    for turn in range(_ROUNDS if wide else 1):
        best = minima[0]
        grid = [] if turn and best.adequate else [*_grid(best, wide)]
        ends = (fit_decays(fit.decays, fit.k, start) for start in _promising(thin, best, grid))
        minima = _distinct([*minima, *filter(None, ends)], best)
        if best.chi_square - minima[0].chi_square < _LOWER_MINIMUM:
            break
    return minima


def _distinct(ends: Sequence[End], fit: RingFit) -> list[End]:
    """The lowest ends of climbs that differ from each other by more than standard errors of a fit, the lowest first."""
    kept: list[End] = []
    for end in sorted(ends, key=lambda end: end.chi_square):
        if kept and end.chi_square > kept[0].chi_square + _KEPT_ABOVE:
            break
        apart = (np.abs(end.point - other.point)[: len(OSCILLATOR_UNKNOWNS)] for other in kept)
        if all((distance > _SAME_MINIMUM * fit.errors).any() for distance in apart):
            kept.append(end)
    return kept


def _promising(thin: Sequence[Decay], fit: RingFit, grid: Sequence[Array]) -> list[Array]:
    """Where climbs on all samples nearly end, apart from each other: from the points of a grid that are best on thinned
    samples, from other contacts and frictions, and from the other side of kinks."""
    samples, whole = (DecaySamples.of(of, fit.k, fit.point.size) for of in (thin, fit.decays))
    rough = samples.climbs(grid, range(len(OSCILLATOR_UNKNOWNS)), gain=1.0, most=3)
    stiffnesses = np.array([*_SCANNED, *(K_z / fit.k for K_z, _ in ringing(fit, fit.decays))])
    tried = [*rough[:_THIN_STARTS], *_along(samples, fit, RHO, 1.0 / np.sqrt(stiffnesses * fit.k))]
    if fit.F_k > 0.0 and fit.free[F_K]:
        tried += _along(samples, fit, F_K, fit.F_k * _FRICTIONS)
    ends = samples.climbs((end.point for end in tried), gain=_GAIN_ON_THE_WAY, most=12)
    near = [*(end.point for end in _distinct(ends, fit)[:_POLISHED]), *_beyond_kinks(fit)]
    ends = _distinct(whole.climbs(near, gain=_GAIN_ON_THE_WAY, most=12), fit)
    return [end.point for end in ends[:_POLISHED]]


def _along(samples: DecaySamples, fit: RingFit, j: int, values: Array) -> list[Climb]:
    """The local minima of χ² along values of unknown j, up to 30 above the least; the others follow from that of the
    fit on, either way."""
    given = {*np.flatnonzero(~fit.free).tolist(), j}
    values = np.sort(np.append(values, fit.point[j]))
    ends = []
    for some in (values[values >= fit.point[j]], values[values < fit.point[j]][::-1]):
        point = fit.point
        for value in some:
            start = point.copy()
            start[j] = value
            end = samples.climb(start, given, gain=0.5, most=3)
            if end is not None:
                ends.append(end)
                point = end.point
    ends.sort(key=lambda end: float(end.point[j]))
    level = np.array([math.inf, *(end.chi_square for end in ends), math.inf])
    lowest = (level[1:-1] <= level[:-2]) & (level[1:-1] <= level[2:])
    lowest &= level[1:-1] < level.min() + _KEPT_ABOVE
    some = [ends[i] for i in np.flatnonzero(lowest)]
    return sorted(some, key=lambda end: end.chi_square)[:_LINES]


def ringing(fit: RingFit, decays: Sequence[Decay], wait: float = 0.0) -> list[tuple[float, float]]:
    """K_z = mΩ² − k of the contacts on which the mass at rest rings at a line of the spectrum, and what each line gains
    in the likelihood's logarithm, the largest first.

    decays : those of the fit, or longer ones.   wait : s after the mass came to rest.
    """
    tails = []
    for i, one in enumerate(decays):
        since = one.start + fit.sticks_from(i, one.end) + wait
        for signal in one.signals if since < one.end else ():
            tail = signal.between(since, one.end)
            if tail.t.size >= _FEWEST_AT_REST:
                tails.append(((tail.values - tail.values.mean()) / tail.noise, tail.dt))
    if not tails:
        return []
    longest = max(values.size * dt for values, dt in tails)
    slipping = math.sqrt(fit.k / fit.m)
    Omega = np.arange(1.2 * slipping, math.pi / min(dt for _, dt in tails), 0.5 * math.pi / longest)
    gain = np.zeros(Omega.size)  # by a line of any phase in each of the tails
    for values, dt in tails:
        size = 4 << (values.size - 1).bit_length()
        power = np.abs(np.fft.rfft(values, size)) ** 2 / values.size
        gain += np.interp(Omega * (dt * size / (2.0 * math.pi)), np.arange(power.size), power)
    around = np.concatenate([[0.0], gain, [0.0]])
    peaks = np.flatnonzero((gain >= around[:-2]) & (gain >= around[2:]))
    peaks = peaks[np.argsort(-gain[peaks], kind="stable")][:_LINES]
    peaks = peaks[gain[peaks] > gain[peaks[:1]].sum() - _LESS_LIKELY]
    lines = zip(fit.m * Omega[peaks] ** 2 - fit.k, gain[peaks], strict=True)
    return [(float(K_z), float(by)) for K_z, by in lines if K_z > 0.1 * fit.k]


def _grid(fit: RingFit, wide: bool) -> Iterator[Array]:
    """Points of a grid over the stiffness of the contact and the share of friction in the loss of energy.

    In a wide search the loss itself is varied as well: with each half cycle more or fewer until the mass sticks, χ² has
    another minimum. Where the fit is not adequate, so is the mass, which rings on its contact as fast as that of the
    fit.
    """
    loss, ratio = loss_of(fit)
    own, stiffnesses = fit.point[RHO] ** -2, [fit.k * by for by in _STIFFER]
    shares = (fit.F_k / loss, *_SHARES_OF_LOSS) if loss > 0.0 else _SHARES_OF_LOSS
    grids: list[tuple[Sequence[float], ...]] = [((1.0,), shares, (own, *stiffnesses), (1.0,))]
    if wide:
        grids.append((_LOSSES, _FINER, (own,), (1.0,)))
    if wide and not fit.adequate:
        grids.append((_LOSSES[::2], _SHARES_OF_LOSS, (own,), _OTHER_MASSES))
    for of_loss, share, stiffness, mass in itertools.chain(*(itertools.product(*g) for g in grids)):
        together = mass * (fit.k + stiffness) - fit.k
        start = fit.point.copy()
        start[fit.friction_places] *= of_loss * share * loss / fit.F_k if fit.F_k > 0.0 else 1.0
        start[C] = of_loss * (1.0 - share) * loss / ratio
        start[RHO], start[M] = max(together, 0.1 * fit.k) ** -0.5, mass * fit.m
        yield start


def loss_of(fit: RingFit) -> tuple[float, float]:
    """Loss of energy of the first decay over its travel, N, and ∫ ẋ² dt over it, m/s: F_k + ratio · c is the loss."""
    # ∫ ẋ² dt of half a cycle is π/4 of the top speed times the travel
    ratio = 0.25 * math.pi * float(np.abs(fit.phases(0)[:, PHASE_V]).max())
    return fit.F_k + ratio * fit.c, max(ratio, 1e-300)


def _beyond_kinks(fit: RingFit) -> Iterator[Array]:
    """Points on the other side of kinks next to a fit: with the contact spring of a decay loaded differently at its
    start, and some standard errors away along each common unknown."""
    for j, side in itertools.product((F_K, C, RHO), (-_ERRORS_ASIDE, _ERRORS_ASIDE)):
        if fit.errors[j] > 0.0:
            start = fit.point + side * fit.covariance[:, j] / fit.errors[j]
            if (start[: len(OSCILLATOR_UNKNOWNS)] > 0.0).all():
                yield start
    for i, preload in itertools.product(range(len(fit.decays)), _PRELOADS):
        place = fit.places(i).stop - 1
        if abs(fit.point[place] - preload) > _PRELOAD_APART:
            start = fit.point.copy()
            start[place] = preload
            yield start


def _thinned(one: Decay, most: int) -> Decay:
    """A decay with every n-th sample, about as many as asked for."""
    n = max(1, one.samples // most)
    signals = tuple(replace(s, t=s.t[::n], values=s.values[::n]) for s in one.signals)
    return replace(one, signals=signals)
