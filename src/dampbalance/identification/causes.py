"""Departures of records from one oscillator: which are in them, what they are called, and what helps.

A departure is a nuisance of the model (`fit/nuisances.py`), zero unless it is freed, or the other frame: motions
relative to the base that were taken for absolute, or the other way round. A score test (`fit/score.py`) says to first
order what each would explain of what a fit leaves; the likeliest are left free, one at a time, and the oscillator is
fitted again. One that brings χ² down to the noise explains the records, and its oscillator is the answer; those whose
χ² is about as low explain them as well, and the intervals hold the numbers of all.

One departure is special. A contact that yields gradually has nearly the harmonics of one that yields at once, with
another stiffness: of what lies between, little more than the loss while it yields shows in a record. The sum of the
squares of the residuals hardly notices; the one direction in which such a contact differs, and the one sign, tell the
most. All such contacts nearly share it: that of Iwan with a uniform distribution, whose corner is a parabola, stands
for those of Dahl, Bouc–Wen and several sliders.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from scipy import special

from ..findings.finding import UNBOUNDED, Finding
from ..fit.fit import OscillatorFit
from ..fit.fundamentals import FundamentalFit
from ..fit.nuisances import NUISANCES, in_other_frame
from ..fit.score import Departure
from ..fit.steady_search import fit_from, fit_records, refit
from ..fit.waveforms import NO_MOTION, WaveformFit
from ..motion.law_decays import ADDED
from ..signals.record_harmonics import RecordHarmonics
from ..signals.thresholds import AS_WELL, P_CAUSE, P_DEPARTURE
from ..solver import NORMAL_95

LIKELY = 0.3
"""Share of what noise does not explain, from which on a departure is worth a fit, or a word."""

TURNS = ("corner", "delay")
"""Departures that turn the phase of the response: away from resonance, damping does so, too."""

ONE_SIGNED = [name for name, (least, _) in NUISANCES.items() if least == 0.0]

GRADUAL = ADDED[-1]
"""The departure that hardly shows: see above."""

FRAME = "frame"


CAUSES = (
    "delay",
    "corner",
    "gain",
    FRAME,
    "friction_level",
    "friction_speed",
    "c_2",
    "k_3",
    GRADUAL,
)
"""All departures that are known: to add one is a code here and in the table of findings, and one of the nuisances."""

NOT_IN_ROWS = frozenset({"k_3"})
"""Departures that rows of the balance, which take the records as they are, do not have."""

_NAMED = ("delay", "gain")
"""Departures whose sign is in the words."""


def departure(name: str, value: float, error: float) -> Finding:
    """Return a departure with its size and standard error."""
    less, unsure = value < 0.0, not error < abs(value)
    size = (abs(value) if name in _NAMED else value, error)
    return Finding(name, {"size": size, "less": less, "unsure": unsure})


@dataclass(frozen=True, slots=True)
class Explanation:
    """A fit that explains the records with departures left free.

    names : of the departures.   fit : the oscillator without them.
    """

    names: tuple[str, ...]
    fit: WaveformFit

    @property
    def departures(self) -> tuple[Finding, ...]:
        """The departures with their sizes."""
        fit = self.fit
        if FRAME in self.names:
            return (Finding(FRAME, {"absolute": not fit.lines[0].of_base}),)
        return tuple(departure(n, fit.value(n), fit.error(n)) for n in self.names)

    @property
    def doubts(self) -> dict[str, float]:
        """Relative errors that numbers may have without a trace in the fit."""
        fit = self.fit
        doubts: dict[str, float] = {}
        # F_k is in proportion to the size of the motion, which no gain of a relative response asks for
        if "gain" in self.names and not any(one.of_base for one in fit.lines):
            doubts = {
                key: abs(fit.value("gain")) for key in fit.law.unknowns if key.symbol == "F_k"
            }
        if GRADUAL in self.names:
            doubts["K_z"] = fit.value(GRADUAL)
        return doubts


def explanations(
    fit: WaveformFit,
    lines: Sequence[RecordHarmonics],
    *,
    penalty: Callable[[WaveformFit], float],
    near: FundamentalFit | None = None,
    frames: bool = False,
) -> tuple[Explanation, ...]:
    """Return the departures that explain what a fit leaves, each with its fit, the likeliest first, and those that
    explain it as well.

    lines : of the records.   penalty : χ² that a mass which is given adds to a fit.   near : the fit to the
    fundamentals, where the waveforms do not hold.   frames : whether the response may be in the other frame.
    """
    excess = 0.0 if fit.adequate else LIKELY * (fit.chi_square - fit.freedom)
    tested = sorted(fit.departures.items(), key=lambda one: -abs(one[1].size))
    least = {name: _least(name, lines) for name in (*NUISANCES, FRAME)}
    likely = [n for n, one in tested if _may_be(one, fit) and one.size**2 > max(least[n], excess)]
    if {"c", "c_r"} <= set(fit.law.unknowns):
        # a damper to the base and one to the ground together make up for any delay
        likely = [name for name in likely if name != "delay"]
    # behind four the first order is no guide
    fits: list[tuple[tuple[str, ...], WaveformFit | None]]
    fits = [((name,), _converged(_with(fit, name))) for name in likely[:4]]
    if near is not None:
        start = replace(fit.problem.like(near), free=fit.parameters.free)
        for turned in _like(near):
            moved = start.freed(*turned).moved(**turned)
            fits.append(((*turned,), _converged(fit_from(fit.problem, moved))))
    if frames:
        # where it holds, the nearest starts lead there: no wide search for what most records are not
        others = [in_other_frame(one) for one in lines]
        fits.append(((FRAME,), fit_records(others, fit.k, fit.law, thorough=False)))

    def misfit(one: Explanation) -> float:
        return one.fit.chi_square + penalty(one.fit)

    found = [Explanation(names, one) for names, one in fits if one is not None]
    own = fit.chi_square + penalty(fit)
    found = [
        one
        for one in found
        if one.fit.adequate
        and own - misfit(one) > min(least[name] for name in one.names)
        and not any(
            one.fit.value(n) in _limits(n, one.fit) for n in one.names if n not in (FRAME, GRADUAL)
        )
    ]
    best = min(map(misfit, found), default=0.0)
    ordered = sorted(
        (one for one in found if misfit(one) < best + AS_WELL), key=misfit, reverse=True
    )
    # of two fits with the same departure, which may come from two starts, the last
    return tuple({one.names: one for one in ordered}.values())[::-1]


def moves(fit: FundamentalFit) -> bool:
    """Return whether all motions of a fit are found again from nothing, under the drives that were read: its features,
    and the travel that its sticking takes, need them."""
    try:
        return bool(fit.responses)
    except NO_MOTION:
        return False


def _converged(fit: WaveformFit | None) -> WaveformFit | None:
    """Return the fit that further climbs lead to, until one ends in an optimum: one that takes more than three is no
    guide, nor is one that stays far from the records."""
    for _ in range(3):
        if fit is None or fit.converged:
            break
        before, fit = fit, refit(fit)
        # four times the noise squared, as where a search gives a start up
        if fit is not None and fit.misfit > 4.0 and fit.chi_square > 0.5 * before.chi_square:
            break
    return fit


def _like(near: FundamentalFit) -> Iterator[dict[str, float]]:
    """Yield the departures of a fit to the fundamentals with their values, and with the AC coupling that turns the
    phase of the first record as far as its delay does."""
    values = {name: near.value(name) for name in near.departures}
    if values:
        yield values
    if values.get("delay", 0.0) < 0.0:
        omega = near.problem.exact.lines[0].omega
        corner = math.tan(min(-omega * values.pop("delay"), 0.75)) * omega / (2.0 * math.pi)
        yield {**values, "corner": corner}


def _with(fit: WaveformFit, name: str) -> WaveformFit | None:
    """Return the fit with a departure left free.

    The turn of a phase trades with c and m along a valley of χ² that is as narrow as the noise and curved, in which a
    climb from no turn crawls: it begins at the oscillator that has the turn of the score test, or what of it leaves
    each coefficient a tenth.
    """
    if name not in TURNS:
        return refit(fit, [name])
    one = fit.departures[name]
    falls = [-changes(one, fit, one.value).get(key, 0.0) for key in fit.law.unknowns]
    near = refit(fit, given={name: one.value / max(1.0, *(fall / 0.9 for fall in falls))})
    return refit(near if near is not None and near.chi_square < fit.chi_square else fit, [name])


def _least(name: str, lines: Sequence[RecordHarmonics]) -> float:
    """Return the fall of χ² from which on a departure is there; one that has one sign only has half of the chances."""
    p = P_CAUSE if name in (GRADUAL, *TURNS) else P_DEPARTURE
    return fall_of(2.0 * p if name in ONE_SIGNED else p, lines)


def fall_of(p: float, lines: Sequence[RecordHarmonics]) -> float:
    """Return the fall of χ² by one unknown that noise exceeds with a probability p: of few cycles, whose scatter gives
    the errors of the fundamentals, a larger one."""
    freedom = sum(2 * max(1, one.rows - 1) for one in lines)
    return float(special.fdtri(1.0, freedom, 1.0 - p))


def _limits(name: str, fit: WaveformFit) -> tuple[float, float]:
    """Return the least and the greatest value of a departure that a rig may have."""
    one = fit.parameters[name]
    return one.low, one.high


def _may_be(one: Departure, fit: WaveformFit) -> bool:
    """Return whether a departure of that size can be; a contact that yields more suddenly than at once is none."""
    low, high = _limits(one.symbol, fit)
    return low < one.value and (one.value < high or one.symbol == GRADUAL)


def shown_by(found: Sequence[Explanation], fall: float) -> Finding:
    """Return the finding of departures that explain the records, the first of which is in the answer.

    fall : of χ².
    """
    first, *others = found
    as_well = tuple(one.departures for one in others)
    numbers = {"causes": first.departures, "fall": fall, "others": as_well}
    return Finding("departs", numbers, first.doubts)


def hint_of(found: Sequence[Explanation], fall: float, fit: WaveformFit) -> Finding:
    """Return the finding of departures that would explain the records, and that the balance contradicts.

    fall : of χ² by the first.   fit : without them, which is the answer.
    """
    doubts: dict[str, float] = {}
    for one in found:
        ends = {key: one.fit.interval(key) for key in fit.law.unknowns}
        values = {key: fit.value(key) for key in ends} | {"K_z": fit.K_z}
        for key, (low, high) in (ends | {"K_z": one.fit.K_z_interval}).items():
            off = max(abs(low - values[key]), abs(high - values[key]))
            doubts[key] = max(doubts.get(key, 0.0), off / (abs(values[key]) or math.inf))
    causes = tuple(one.departures for one in found)
    return Finding("hints", {"causes": causes, "first": causes[0], "fall": fall}, doubts)


def doubts_of(one: Departure, fit: OscillatorFit) -> Mapping[str, float]:
    """Return by what part a departure that is not fitted may move each number: to first order, and without bound
    where it imitates friction and damping. A spring or a contact that yields otherwise moves neither; the contact is
    then as much stiffer after a reversal."""
    if one.symbol in ("corner", "friction_speed"):
        return UNBOUNDED
    moved = {s: abs(part) for s, part in changes(one, fit, one.value).items()}
    beside = {"k_3": {*moved}, GRADUAL: {*moved} - {"K_z"}}.get(one.symbol, ())
    return {s: part for s, part in moved.items() if s not in beside}


def condition_on_contact(fit: OscillatorFit, tested: Iterable[Departure]) -> list[Finding]:
    """Return a finding where K_z depends on the contact yielding at once by more than its interval shows, and the
    records could not tell one that yields gradually from it; none where they could.

    It is a condition and no doubt, as of all numbers on the gains: K_z and its interval are those of the contact that
    was asked for, which moves like one that yields gradually and is stiffer after a reversal.   tested : all that was
    tested.
    """
    for one in tested:
        if one.symbol != GRADUAL or fit.rigid:
            continue
        # Dahl's contact is twice as stiff after a reversal as the nearest that yields at once: 1.5 is the roundest
        most = min(max(one.value, 0.0) + NORMAL_95 * one.error, 1.5)
        part = changes(one, fit, most).get("K_z", 0.0)
        # less than 3 % of K_z, or than three of its standard errors, is worth no word
        if part > max(0.03, 3.0 * fit.K_z_error / fit.K_z):
            return [Finding("contact taken as sudden", {"by": part})]
    return []


def changes(one: Departure, fit: OscillatorFit, value: float) -> dict[str, float]:
    """Return the relative change of the numbers of a fit with a coefficient of this value, by symbol."""
    parts = {s: by * value / (fit.value(s) or 1.0) for s, by in one.slopes.items()}
    if "rho" in parts:
        # after a reversal the contact is as much stiffer as its corner is rounded
        parts["K_z"] = -2.0 * parts.pop("rho") + (value if one.symbol == GRADUAL else 0.0)
    return parts


def likeliest(fit: WaveformFit) -> Departure | None:
    """Return the departure that can be and explains most of what a fit leaves that is not adequate, to first order;
    None where none explains a part that is worth a word."""
    possible = (one for one in fit.departures.values() if _may_be(one, fit))
    best = max(possible, key=lambda one: abs(one.size), default=None)
    excess = fit.chi_square - fit.freedom
    return best if best is not None and best.size**2 > LIKELY * excess else None
