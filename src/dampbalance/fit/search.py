"""The search for the oscillator of free decays: each by itself over a growing part of it, then all together.

Between two turns of a free motion that slips the swing D falls by

    D_{i+1} = e^{−βπ} D_i − 2(1 + e^{−βπ}) F_k/k,      β = ζ/√(1 − ζ²),

a line through the pairs of swings in the band of the mode, which gives F_k and c; the period gives m. A fit begins in
the middle of a swing, where the contact slips, over 1.3 periods, and follows the motion over windows that grow. A scan
along K_z finds the contact, and then the start is moved back for as long as the samples follow the motion: what held or
pushed the mass before is left out.

Where the residual is not white noise in all the band of the samples, the decay is fitted in that of the mode, from the
earliest swing on after which the residual there does not fall any more.
"""

from __future__ import annotations

import itertools
import math
import sys
from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np
from scipy import special

from ..motion.events import PHASE_S, PHASE_X
from ..motion.unknowns import OSCILLATOR_UNKNOWNS
from ..signals.band import Band
from ..signals.bursts import Burst, Signal, bursts_of, sharpest
from ..signals.thresholds import NEVER, P_OF_THE_MODEL, P_STEP_BACK, SIGNIFICANT
from ..solver import NORMAL_95
from .climb import MOST_EVALUATIONS, Climb
from .decay import FURTHER, STATE, Decay, DecayFit, DecayProblem, offset_of, with_noise_of
from .multistart import climb_on, climbs, likely, multistart, profile
from .parameters import Parameters
from .swings import SLOWER, Swings

_FIRST_STIFFNESSES = (4.0, 30.0, 300.0)  # of K_z/k: from there a climb reaches any that shows
# Shares of friction in the loss of a swing, where the line through the swings misleads, and losses with shares next to
# a fit.
_SHARES = (0.1, 0.5, 0.9)
_LOSSES, _FINER = (0.85, 1.0, 1.15), (0.05, 0.3, 0.55, 0.8, 0.98)
# cycles that are fitted first: two turns and the way there; growth from one to the next
_FIRST, _GROWTH = 1.3, 1.7
_FEWEST_SAMPLES = 4 * (len(OSCILLATOR_UNKNOWNS) + len(STATE))  # samples of a decay
_BACK, _MOST_BACK = 24, 30  # steps of a cycle in which the start moves back, and their number
_PRELOADS = (0.0, 1.0, 2.0)  # w of a contact that yields either way, and of one that is slack
_SEVERAL = 3  # steps back that are looked at together
_SETTLED = 1.25  # of the least mean square of the residual in the band: nothing is disturbed
_LONG = 300  # cycles of a decay, of more of which excerpts are fitted
_EXCERPTS, _EXCERPT = 8, 150  # their number, and the cycles of each at most
_LATEST = 3.0  # cycles after the turn, to which a disturbance of the release may last
_LONGER = 1.5  # growth of a tail: the phase of the ringing is known half as far ahead again
_OTHER_MOTION = (
    0.3  # of the motion in its band: with a larger residual it is not that of an oscillator
)
_FEWEST_FREE = 2.0  # degrees of freedom in the band, below which any motion fits
_LEAST_SWING = 0.1  # of the swing of a burst, that its motion has at least
_MOST_HALF_CYCLES = 4  # half cycles that slip, of a burst that may be the work of a hand
_ROUGH = 1e-2  # of half of χ²: where a climb on the way ends
_NEAR_MINIMUM = np.arange(-8, 9) * 0.5  # standard errors of ρ about a minimum
_IN_INTERVAL = NORMAL_95**2  # of χ²


def separate_fits(
    source: str, signals: Sequence[Signal], k: float, pendulum: bool = False
) -> tuple[list[DecayFit], list[Burst]]:
    """Return a fit of each free decay in the channels of a record by itself, in their order, and the bursts that no
    oscillator fits or in which nothing slips.

    source : of the record.   signals : its channels, their offsets numbered through all records.   k : N/m.
    pendulum : whether the restoring torque is k sin x.
    Raises NoDecay.
    """
    lead = sharpest(signals)
    bursts = bursts_of(lead)
    fits: dict[Burst, DecayFit] = {}
    surest, blank = None, DecayProblem((), k, pendulum=pendulum)
    for _ in range(2):
        for burst in bursts:
            if burst in fits and fits[burst].white:
                continue
            # a motion that is not that of an oscillator does not show where it ends
            sure = {b: fit for b, fit in fits.items() if fit.white}
            before = (fit.decays[-1].end for b, fit in sure.items() if b.turn < burst.turn)
            earliest = max(burst.earliest, *before, -math.inf)
            cut = replace(burst, earliest=earliest)
            fit = _of_burst(source, signals, lead, cut, blank, surest)
            if fit is not None and (burst not in fits or fit.white):
                fits[burst] = fit
        # the oscillator of one decay is where others start from that were not found by themselves
        white = [burst for burst, fit in fits.items() if fit.white and slips_of(fit)]
        surest = fits[max(white, key=lambda burst: burst.swing)] if white else None
        if surest is None:
            break
    kept = {burst: fit for burst, fit in fits.items() if sound(fit)} or fits
    kept = {burst: fit for burst, fit in kept.items() if slips_of(fit)} or kept
    return [kept[b] for b in bursts if b in kept], [b for b in bursts if b not in kept]


def sound(fit: DecayFit) -> bool:
    """Return whether the residual is small next to the motion, or noise."""
    if fit.problem.band is None:
        return fit.adequate
    return fit.freedom > _FEWEST_FREE and fit.residual_share < _OTHER_MOTION


def _of_burst(
    source: str,
    signals: Sequence[Signal],
    lead: Signal,
    burst: Burst,
    blank: DecayProblem,
    surest: DecayFit | None,
) -> DecayFit | None:
    """Return the fit of a burst, from its release on; None where no oscillator moves as far as it does.

    blank : the problem without decays.   surest : the fit of another burst, to start from as well.
    """
    if surest is not None:
        own = 2.0 * math.pi * math.sqrt(surest.m / blank.k)
        burst = replace(burst, period=max(own, SLOWER * burst.period))
    swings = Swings(lead, burst, blank.pendulum)
    if swings.zeros.size < 2:
        return None
    period = swings.period
    whole = Decay(source, burst.turn, burst.end, tuple(signals), period)
    if swings.zeros.size > 2 * _LONG:
        return _of_excerpts(whole, swings, blank)
    starts = [t for t in swings.zeros if t > burst.turn - 0.3 * period]
    fit = _grown([whole.cut(starts[0], whole.end)], swings, blank, surest) if starts else None
    if fit is None:
        return None
    wide = _whitened(fit)
    if wide is None:
        fit = _band_from_earliest(whole, swings, starts, fit) or fit
        # from there all the band may be white after all
        unfiltered = replace(fit.problem, band=None)
        wide = _whitened(unfiltered.climb(unfiltered.posed(fit.parameters)))
    if wide is not None:
        fit = with_noise_of(_from_earlier(with_noise_of(wide), burst.earliest))
    if fit.problem.samples < _FEWEST_SAMPLES:
        return None
    # else the swing was not that of a free motion
    return fit if float(np.ptp(fit.phases(0)[:, PHASE_X])) > _LEAST_SWING * burst.swing else None


def _of_excerpts(whole: Decay, swings: Swings, blank: DecayProblem) -> DecayFit | None:
    """Return the fit of some excerpts of a decay of very many cycles, each with a start state: they share F_k, c and m,
    and take little time. The first begins after what the release disturbs."""
    zeros = swings.zeros
    cycles = min(_EXCERPT, zeros.size // (2 * _EXCERPTS + 4))
    places = np.linspace(2.0 * _LATEST, zeros.size - 2 * cycles, _EXCERPTS).astype(int)
    parts = [whole.cut(t, t + cycles * whole.period) for t in zeros[places].tolist()]
    of_cycles = zeros.size // 2
    if sys.stderr.isatty():
        print(f"fitting excerpts of a decay of {of_cycles:,} cycles …", file=sys.stderr)
    parts = [replace(one, whole=None, of_cycles=of_cycles) for one in parts]
    fit = _grown(parts, swings, blank)
    white = _whitened(fit)
    if fit is None or white is not None:
        return white and with_noise_of(white)
    # what is not white may have led it astray, to an early rest
    problem = replace(fit.problem, decays=tuple(parts))
    F_k, c, m = swings.oscillator(blank.k)
    stiff = 1.0 / math.sqrt(_FIRST_STIFFNESSES[-1] * blank.k)
    start = {"F_k": F_k, "c": c, "rho": stiff, "m": m, **_states_at(parts, swings)}
    return in_the_band(replace(fit, problem=problem), problem.parameters(start))


def _states_at(parts: Sequence[Decay], swings: Swings) -> dict[str, float]:
    """Return the start states of decays by key."""
    states = [one.state(*swings.start_at(one.start).tolist()) for one in parts]
    return {key: value for state in states for key, value in state.items()}


def _grown(
    parts: Sequence[Decay], swings: Swings, blank: DecayProblem, surest: DecayFit | None = None
) -> DecayFit | None:
    """Return the best fit of a decay, or of excerpts of it, from the middle of a swing on, over windows that grow."""
    first, problem = parts[0], replace(blank, decays=tuple(parts))
    contacts = [1.0 / math.sqrt(stiffness * blank.k) for stiffness in _FIRST_STIFFNESSES]
    F_k, c, m = swings.oscillator(blank.k)
    known = {"m": m, **_states_at(parts, swings)}
    for signal in first.signals:
        last = signal.values[-(signal.values.size // 4) - 1 :]
        known[offset_of(signal)] = float(np.median(last))
    # the loss of a swing by friction and by damping, with all of it in other shares
    per_c = 0.25 * math.pi * abs(known[first.key("v")])

    def mixture(loss: float, share: float, rho: float) -> dict[str, float]:
        return {"F_k": share * loss, "c": (1.0 - share) * loss / per_c, "rho": rho}

    loss = F_k + per_c * c
    mixtures = [mixture(loss, share, rho) for share in (F_k / loss, *_SHARES) for rho in contacts]
    mixtures += [] if surest is None else [surest.parameters.by_key]
    points = [problem.parameters({**known, **one}) for one in mixtures]
    ends, length, duration = list[Climb](), _FIRST * first.period, first.end - first.start
    while True:
        window = problem
        if length < duration:
            cut = (one.cut(one.start, one.start + length) for one in parts)
            window = replace(problem, decays=tuple(cut))
        if window.samples >= _FEWEST_SAMPLES or length >= duration:
            ends = climbs(window.thinned(), points, math.inf)
            points = [problem.posed(one.parameters) for one in ends] or points
        if length >= duration:
            break
        length *= _GROWTH
    if not ends:
        return None
    problem = _until_rest(problem, problem.thinned().fit(ends[0]))
    fit = _best(problem, points, "rho")
    if fit is None or len(parts) > 1:
        return fit
    # another number of half cycles, or of those that friction takes, is another minimum
    loss, here = fit.F_k + per_c * fit.c, problem.posed(fit.parameters)
    tried = itertools.product(_LOSSES, _FINER, [here["rho"].value, *contacts])
    more = [here.moved(**mixture(by * loss, share, rho)) for by, share, rho in tried]
    best = _best(problem, [here, *more])
    return best if best is not None and best.chi_square < fit.chi_square else fit


def _until_rest(problem: DecayProblem, fit: DecayFit) -> DecayProblem:
    """Return the problem without the samples long after the mass came to rest."""
    decays = []
    for i, one in enumerate(problem.decays):
        end = fit.at_rest(i, one.end)
        decays.append(one.cut(one.start, end) if end < one.end else one)
    return replace(problem, decays=tuple(decays))


def to_the_end(fit: DecayFit) -> DecayFit:
    """Return the fit of the same decays with what follows after the mass came to rest, where its ringing shows K_z.

    The tails grow for as long as they follow the motion, so that the phase of the ringing is known from one to the
    next: a hand that touches the mass ends them. Where no ringing stands out of the noise, the fit stays as it is.
    """
    first, points = fit.decays, [one.parameters for one in (fit, *fit.minima)]

    def with_tail(i: int, length: float) -> Decay:
        one = first[i]
        of_record = (other.start for other in first if other.source == one.source)
        limits = (start for start in of_record if start > one.start)
        return one.recut(one.start, min(one.end + length * one.period, *limits, math.inf))

    decays, length, shown = list(first), 1.0, 0.0
    growing = [
        i for i in range(len(first)) if fit.white and with_tail(i, length).end > first[i].end
    ]
    while growing:
        longer = [with_tail(i, length) if i in growing else one for i, one in enumerate(decays)]
        problem = replace(fit.problem, decays=tuple(longer))
        ends = climbs(problem, points)
        if not ends:
            break
        here, predicted = problem.fit(ends[0]), replace(fit, problem=problem, parameters=points[0])
        gains = {i: _gain(here, predicted, i, decays[i].end) for i in growing}
        lost = [i for i, gain in gains.items() if gain == -math.inf]
        for i in lost:  # what disturbs it may have begun in the part before
            decays[i] = with_tail(i, length / _LONGER**2 if length > _LONGER else 0.0)
        if not lost:
            shown += math.fsum(gains.values())
            decays, points, length = longer, [one.parameters for one in ends], _LONGER * length
        growing = [i for i in growing if i not in lost and with_tail(i, length).end > decays[i].end]
    if shown < SIGNIFICANT**2:
        return fit
    problem = replace(fit.problem, decays=tuple(decays))
    longest = _best(problem, points)
    return longest if longest is not None and longest.white else fit


def _gain(fit: DecayFit, predicted: DecayFit, i: int, since: float) -> float:
    """Return the fall of χ² from a level to the ringing in the samples of decay i from a time on, s; −∞ where the fit
    leaves more than noise there, or where the ringing that was predicted is not there."""
    square = at_level = expected = n = 0.0
    pairs = zip(fit.residuals(), predicted.residuals(), strict=True)
    for (j, signal, residual), (*_, before) in pairs:
        new = signal.t >= since
        if j == i and new.any():
            values, left = signal.values[new] / signal.noise, residual[new]
            square += float(left @ left)
            at_level += float(np.sum((values - np.mean(values + left)) ** 2))
            expected += values.size * float(np.var(values + before[new]))
            n += values.size
    gain = at_level - square
    least = min(0.5 * expected, expected - SIGNIFICANT * math.sqrt(expected))
    follows = gain >= least and (
        n == 0.0 or special.fdtrc(n, predicted.freedom, square / n) > NEVER
    )
    return gain if follows else -math.inf


def _best(problem: DecayProblem, starts: Sequence[Parameters], scan: str = "") -> DecayFit | None:
    """Return the lowest minimum that a search finds, which keeps those in mind that are nearly as low."""
    fits = multistart(problem, starts, scan=scan)
    return replace(fits[0], minima=tuple(fits[1:])) if fits else None


def _from_earlier(fit: DecayFit, earliest: float) -> DecayFit:
    """Return the fit with the start moved back for as long as the samples follow the motion."""
    (one,) = fit.decays
    step = one.period / _BACK
    earliest -= 0.5 * min(signal.dt for signal in one.signals)
    # the same samples for all starts
    thin = one.recut(max(earliest, one.start - _MOST_BACK * step), one.end).thinned()
    here = replace(fit.problem, decays=(thin.cut(one.start, one.end),))
    fits = [*filter(None, [here.climb(fit.parameters, gain=_ROUGH)])]
    start = one.start - step
    while fits and start >= thin.start:
        longer = _refit(fits[-1], thin.cut(start, one.end))
        if doubted := _doubted(fits, longer):
            # what stopped it may have begun within the steps that are in doubt
            del fits[max(1, len(fits) - doubted) :]
            break
        fits += [longer] if longer is not None else []
        start -= step
    if len(fits) < 2:
        return fit
    last = replace(here, decays=(one.recut(fits[-1].decays[0].start, one.end),))
    starts = [fits[-1].parameters, *_preloaded(fits[-1].parameters, one)]
    return _best(last, starts, "rho") or fit


def _preloaded(start: Parameters, one: Decay) -> list[Parameters]:
    """Return a start with the contact of a decay loaded in one way or another."""
    return [start.moved(**{one.key("w"): preload}) for preload in _PRELOADS]


def _refit(fit: DecayFit, part: Decay) -> DecayFit | None:
    """Return the fit of a decay that begins a step earlier, with the contact loaded in one way or another."""
    climb = partial(replace(fit.problem, decays=(part,)).climb, gain=_ROUGH, most=12)
    start = _before(fit.parameters, part, fit.k, fit.decays[0].start - part.start)
    ends = [climb(start)]
    if _doubted([fit], ends[0]):
        ends += map(climb, _preloaded(start, part))
    return min(filter(None, ends), key=lambda end: end.chi_square, default=None)


def _doubted(fits: Sequence[DecayFit], longer: DecayFit | None) -> int:
    """Return the number of steps back that are in doubt, 0 where the samples follow the motion, judged by the
    contribution of the last step, or of the last three, to χ²."""
    if longer is None:
        return 1
    for count in (1, _SEVERAL):
        here = fits[-count:][0]
        new = longer.problem.samples - here.problem.samples
        excess = longer.chi_square - here.chi_square
        if new > 0 and special.chdtrc(new, max(excess, 0.0)) < P_STEP_BACK:
            return count
    return 0


def _before(start: Parameters, one: Decay, k: float, step: float) -> Parameters:
    """Return the start with about the start state of its decay a step earlier: slipping backwards, and from the other
    side at a turn."""
    F_k, c, m, x, v, preload = (start[one.key(s)].value for s in ("F_k", "c", "m", *STATE))
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
    return start.moved(**one.state(x, v, preload))


def _band_from_earliest(
    whole: Decay, swings: Swings, begins: Sequence[float], fit: DecayFit
) -> DecayFit | None:
    """Return the fit in the band of the mode, from the earliest swing on that the release does not disturb."""
    dt = max(signal.dt for signal in whole.signals)
    band = Band.about(1.0 / whole.period, dt)
    # a fit that the release has led astray may rest too early
    end = min(whole.end, max(fit.decays[0].end, float(swings.zeros[-1]) + whole.period))
    last = min(begins[0] + _LATEST * whole.period, end - 2.0 * _FIRST * whole.period)
    early = [t for t in begins if t <= last] or [*begins[:1]]
    blank = DecayProblem((), fit.k, pendulum=fit.problem.pendulum)
    latest = whole.cut(early[-1], whole.end)
    late = None if len(early) == 1 else _grown([latest], swings, blank)
    points = [one.parameters for one in (fit, late) if one is not None]
    contacts = (1.0 / math.sqrt(stiffness * fit.k) for stiffness in _FIRST_STIFFNESSES)
    points += [points[-1].moved(rho=rho) for rho in contacts]
    fits: list[DecayFit] = []
    for start in reversed(early):
        # the first swings may be those of a spring that is not linear: no reason to leave them out
        part = whole.cut(start, end)
        problem = replace(blank, decays=(part,), band=band).thinned()
        state = part.state(*swings.start_at(start).tolist())
        starts = [problem.posed(point.moved(**state)).freed("k_3") for point in points]
        if ends := climbs(problem, starts):
            fits.append(problem.fit(ends[0]))
            points = [ends[0].parameters]
    if not fits:
        return None
    least = min(one.misfit for one in fits)
    thin = [one for one in fits if one.misfit <= _SETTLED * least][-1]
    problem = replace(thin.problem, decays=(whole.cut(thin.decays[0].start, end),))
    best = _best(_until_rest(problem, thin), [thin.parameters])
    return None if best is None else with_noise_of(best)


def in_the_band(fit: DecayFit, *starts: Parameters) -> DecayFit | None:
    """Return the fit of the same decays in the band of the mode.   starts : to climb from as well."""
    one = fit.decays[0]
    dt = max(signal.dt for decay in fit.decays for signal in decay.signals)
    problem = replace(fit.problem, band=Band.about(1.0 / one.period, dt))
    from_all = (problem.posed(start) for start in (fit.parameters, *starts))
    best = _best(problem, [start.freed("k_3") for start in from_all])
    return None if best is None else with_noise_of(best)


def profiled(fit: DecayFit) -> DecayFit:
    """Return the fit with the points along K_z that are as likely among its minima, which its intervals hold.

    χ² has minima and kinks there, and may be flat: its curvature at the lowest point does not show how far one goes.
    """
    # over which speed friction falls hardly shows in the motion
    problem, thin, here = fit.problem, fit.problem.thinned(), fit.parameters.held("falling_speed")
    error = fit.error("rho")
    if not error > 0.0:
        return fit
    near = here["rho"].value + error * _NEAR_MINIMUM
    values = np.append(problem.scan(here), near[near > problem.rigid])
    ends = likely(profile(thin, here, "rho", values), problem, thin)
    # on all samples each is close to its neighbour, closer than to its place on a few of them
    stiffnesses = np.array([end.parameters["rho"].value for end in ends])
    ends = profile(problem, here, "rho", stiffnesses, gain=_ROUGH, most=MOST_EVALUATIONS)
    along = [problem.fit(end) for end in ends]
    lowest = min(along, key=lambda one: one.chi_square, default=fit)
    if lowest.chi_square < fit.chi_square:
        best = problem.climb(fit.parameters.at(lowest.point))
        if best is not None and best.chi_square < fit.chi_square:
            fit = best
    inside = [one for one in along if one.chi_square < fit.chi_square + _IN_INTERVAL]
    return replace(fit, minima=(*fit.minima, *inside))


def with_one_more(fit: DecayFit) -> DecayFit | None:
    """Return the fit with that of `FURTHER` freed that lowers χ² most; None where none can be followed."""
    thin = fit.problem.thinned()
    starts = [fit.parameters.freed(s) for s in FURTHER if s not in fit.further]
    ends = filter(None, (climb_on(thin, start, gain=_ROUGH, most=12) for start in starts))
    best = min(ends, key=lambda end: end.chi_square, default=None)
    return None if best is None else fit.problem.climb(best.parameters)


def _whitened(fit: DecayFit | None) -> DecayFit | None:
    """Return the fit, or else that with one more coefficient, if its residual is white; None where it is not."""
    more = fit if fit is None or fit.white else with_one_more(fit)
    return more if more is not None and more.white else None


def slips_of(fit: DecayFit) -> int:
    """Return the number of phases in which the mass of a separate fit slips, in the first of its excerpts."""
    return int(np.count_nonzero(fit.phases(0)[:, PHASE_S]))


def fit_all(fits: Sequence[DecayFit]) -> tuple[DecayFit | None, list[Decay]]:
    """Return one oscillator for the decays with these separate fits, and what is no decay at all.

    The decays share c, K_z and m; whether they share F_k is to be weighed. A hand that moves the mass from one place to
    another can look like half a cycle of another oscillator: what slips in a few half cycles only is left out where no
    friction force makes it a motion of the oscillator of the others.
    """
    if len(fits) == 1:
        return fits[0], []
    if len({fit.white for fit in fits}) > 1:
        fits = [one for fit in fits if (one := in_the_band(fit) if fit.white else fit) is not None]
    whole = _fitted_together(fits)
    if whole is None or _same(whole, fits):
        return whole, []
    order = sorted(fits, key=lambda fit: (-slips_of(fit), -fit.problem.samples))
    kept = [fit for fit in order if slips_of(fit) > _MOST_HALF_CYCLES] or order[:1]
    here = _fitted_together(kept)
    for fit in order[len(kept) :]:
        more = _fitted_together([*kept, fit])
        if here is None or (more is not None and _same(more, [here, fit])):
            kept, here = [*kept, fit], more
    left_out = [fit.decays[0] for fit in fits if fit not in kept]
    if left_out:
        whole = _fitted_together([fit for fit in fits if fit in kept])
    return whole, left_out


def _same(whole: DecayFit, parts: Sequence[DecayFit]) -> bool:
    """Return whether the unknowns that a fit has less than fits of its parts are not missed: its χ² lies above theirs
    by no more than chance makes of as many."""
    fewer = sum(fit.parameters.free.sum() for fit in parts) - whole.parameters.free.sum()
    excess = whole.chi_square - math.fsum(fit.chi_square for fit in parts)
    noise = max(1.0, *(fit.misfit for fit in parts))
    return bool(fewer <= 0 or special.chdtrc(fewer, max(excess, 0.0) / noise) > P_OF_THE_MODEL)


def _fitted_together(fits: Sequence[DecayFit]) -> DecayFit | None:
    """Return the fit of all decays, with a friction force for each: from the minima of each in turn."""
    if len(fits) == 1:
        return fits[0]
    decays, known = list[Decay](), dict[str, float]()
    for fit in fits:
        decays += [replace(one, friction=fit.decays[0].label) for one in fit.decays]
        known |= fit.parameters.by_key | {decays[-1].key("F_k"): fit.F_k}
    band = next((fit.problem.band for fit in fits if fit.problem.band is not None), None)
    problem = replace(fits[0].problem, decays=tuple(decays), band=band)
    free = {name for fit in fits for name in fit.free}
    surest = sorted(fits, key=lambda fit: -fit.problem.samples / (1.0 + fit.misfit))
    near = (one for fit in surest[:3] for one in (fit, *fit.minima))
    return _best(problem, [problem.parameters(known | one.shared, free) for one in near])
