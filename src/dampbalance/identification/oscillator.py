"""One oscillator fitted to all records by maximum likelihood, the answer where it holds, which the balance checks."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

from ..findings.finding import UNBOUNDED, Finding
from ..fit.fit import OscillatorFit
from ..fit.fundamentals import FundamentalFit, fit_fundamentals
from ..fit.goodness import LinearFit, improbable, linear_fit
from ..fit.steady_search import fit_from, fit_records, of_all_stiffnesses, refit
from ..fit.waveforms import HarmonicProblem, WaveformFit
from ..law.law import Law
from ..law.terms import FRICTION
from ..signals.mean_harmonics import Reading
from ..signals.record_harmonics import RecordHarmonics
from ..signals.thresholds import P_SHOWN, SHOWS
from ..solver import NORMAL_95
from .answer import FUNDAMENTALS, Answer, answer_of_fit
from .causes import FRAME, NOT_IN_ROWS, Explanation, departure, explanations, fall_of, moves

_DIFFER = 1.05  # ratio of two amplitudes, from which on friction and damping act differently


@dataclass(frozen=True, eq=False)
class CommonFit:
    """One oscillator fitted to all records.

    fit : the oscillator that responds most like them, with the departures that explain them left free; None where no
    oscillator that slips does, or a linear one explains them.
    explained : departures that explain what the oscillator alone does not, the likeliest first, and those that do as
    well.   fall : of χ² by the first.
    mass : kg, as given, or None.   mass_fits : whether the records agree with it.
    fundamentals : the fit to the fundamental of each record alone, where the waveforms are not those of an oscillator.
    plain : the fit without these departures, where it explains the records, too, and a few of such sets as well.
    hinted : departures that the records hint at and the answer is not freed of.
    stuck : the linear oscillator, with the stiffness of a contact that only sticks, where one explains the records
    within their noise: nothing slips, or slip does not show.
    frictionless : whether a balance of these has no friction: the contact sticks, or no two levels differ.
    """

    fit: WaveformFit | None
    explained: tuple[Explanation, ...] = ()
    fall: float = 0.0
    mass: float | None = None
    mass_fits: bool = True
    fundamentals: FundamentalFit | None = None
    plain: WaveformFit | None = None
    hinted: tuple[Explanation, ...] = ()
    stuck: LinearFit | None = None
    frictionless: bool = False

    @property
    def uncorrected(self) -> CommonFit:
        """The plain fit as the answer, which its departures are a hint to."""
        return replace(
            self, fit=self.plain, plain=None, mass_fits=True, explained=(), hinted=self.explained
        )

    @property
    def waveforms_hold(self) -> bool:
        """Whether the waveforms of the fit are those of the records, so that the onset of slip and K_z are known."""
        return self.fit is not None and self.fit.adequate

    @property
    def in_rows(self) -> bool:
        """Whether the records have a departure that the answer is freed of, and rows of the balance are not."""
        freed = () if self.fundamentals is None else self.fundamentals.departures
        names = {*freed, *(name for one in self.explained[:1] for name in one.names)}
        return bool(names - NOT_IN_ROWS)

    @property
    def mass_taken(self) -> bool:
        """Whether the fit has the mass that was given, which the records know less well."""
        return self.mass is not None and self.fit is not None and self.fit.error("m") == 0.0

    @property
    def closest(self) -> OscillatorFit:
        """The fit whose numbers are the answer."""
        fit = self.fundamentals or self._best
        assert fit is not None
        return fit

    @property
    def notes(self) -> tuple[Finding, ...]:
        """What one must know before using the numbers of the fit."""
        fit = self._best
        if fit is None:
            return ()
        far = [] if fit.adequate else [Finding("far", effect=UNBOUNDED)]
        early = [] if fit.converged else [Finding("not converged", effect=UNBOUNDED)]
        none = [key for key in fit.law.unknowns if fit.value(key) <= 0.0]
        return (*far, *early, *(Finding("at its limit", {"symbol": key}) for key in none))

    @property
    def _best(self) -> WaveformFit | None:
        """The fit whose numbers are the answer: of responses in the other frame, where they are in it."""
        return self.explained[0].fit if self.explained else self.fit

    @property
    def delay(self) -> tuple[float, float] | None:
        """Delay of the response that the records show and its standard error, s: fitted, or to first order."""
        fit = self.fit
        if fit is None or not fit.adequate:
            return None
        if fit.parameters["delay"].free:
            return fit.value("delay"), fit.error("delay")
        shown = fit.departures.get("delay")
        return None if shown is None else (shown.value, shown.error)

    @property
    def answer(self) -> Answer | None:
        """The answer of the fit, whose intervals hold the numbers of all departures that explain the records; None
        where no oscillator that slips fits."""
        fit, delay = self._best, self.delay or (None, None)
        if fit is None:
            return None
        answer = answer_of_fit(
            fit,
            fit.law.unknowns,
            self.notes,
            misfit_of_records=fit.misfits,
            delay_s=delay[0],
            delay_standard_error_s=delay[1],
        )
        for other in self.explained[1:]:
            intervals = answer_of_fit(other.fit, fit.law.unknowns, ()).intervals
            answer = replace(
                answer,
                parameters={s: p.holding(intervals[s]) for s, p in answer.parameters.items()},
            )
        return answer

    @property
    def answer_of_fundamentals(self) -> Answer | None:
        """The answer of the fit to the fundamentals; None where the waveforms hold, or there is none."""
        fit = self.fundamentals
        if fit is None:
            return None
        along = tuple(departure(n, fit.value(n), fit.error(n)) for n in fit.departures)
        note = Finding(
            "fundamentals",
            {"scatter": fit.scatter, "causes": along},
            {key: by for key, by in fit.turned.items() if key in fit.law.unknowns},
        )
        return answer_of_fit(fit, fit.law.unknowns, [note], name=FUNDAMENTALS, residual=fit.scatter)


def common_fit(
    lines: Sequence[RecordHarmonics],
    k: float,
    m: float | None = None,
    law: Law | None = None,
    *,
    mass_error: float = 0.0,
    stiffness_error: float = 0.0,
    departures: bool = True,
    frames: bool = False,
) -> CommonFit:
    """Return the oscillator behind the records.

    The records determine the mass by themselves, often better than scales do: the fit takes a mass that is given only
    where it is known better than that, and the records agree with it.

    k : N/m.   m : kg, if it is known.   law : of its damping; default, F_k and c.
    mass_error, stiffness_error : standard uncertainties of m, kg, and of k, N/m: a mass that differs by no more
    contradicts nothing.
    departures : whether departures are looked for; a study that does not read them saves that time.
    frames : whether the response may be in the other frame than it was taken for.
    """
    law = law or Law()
    without = linear_fit(lines, k, law.terms)
    slips = improbable(without.chi_square, without.freedom, lines)
    fit, alone = _searched(lines, k, law, slips)
    fall = 0.0 if fit is None else without.chi_square - fit.chi_square
    linear = fall < SHOWS and not slips
    fit, alone = (None, None) if linear else (fit, alone)

    def penalty(one: OscillatorFit) -> float:
        """Return the χ² that the mass given adds: the square of its difference in standard errors."""
        low, high = one.interval("m")
        error = 0.5 * (high - low) / NORMAL_95
        apart = math.hypot(error, mass_error, stiffness_error / k * one.m)
        return 0.0 if m is None or one.m == m else ((one.m - m) / apart) ** 2

    if fit is None:
        fits = alone is None or penalty(alone) < SHOWS
        stuck = linear_fit(lines, k, law.terms, m, mass_error) if linear else None
        bare = False
        if stuck is not None:
            # k counts once where a force drives, and like mω² where a base moves
            of_k = stiffness_error * max(1.0, stuck.by_mass * (m or 0.0) / k)
            stuck = stuck._replace(contact_error=math.hypot(stuck.contact_error, of_k))
            sizes = [float(abs(one.x[0])) for one in lines]
            alike = len(lines) < len(law.unknowns) or max(sizes) < _DIFFER * min(sizes)
            bare = alike or stuck.sticks is True
        return CommonFit(
            *(None, (), 0.0, m, fits), fundamentals=alone, stuck=stuck, frictionless=bare
        )
    error = fit.error("m")
    given = refit(fit, given={"m": m}) if m is not None and mass_error < error else None
    # χ² rises by the square of the difference over the error of the records alone
    most = SHOWS * (1.0 + (mass_error / error) ** 2) if error else SHOWS
    fits = given is not None and given.chi_square - fit.chi_square < most
    fit = given if given is not None and fits else fit

    found: tuple[Explanation, ...] = ()
    if departures:
        unsure = frames and not (fit.adequate and penalty(fit) < SHOWS)
        found = explanations(fit, lines, penalty=penalty, near=alone, frames=unsure)
    if not found:
        fits = penalty(alone or fit) < SHOWS
        return CommonFit(fit, mass=m, mass_fits=fits, fundamentals=alone)
    best = found[0].fit
    fall = fit.chi_square + penalty(fit) - best.chi_square - penalty(best)
    chance = fall < fall_of(P_SHOWN, lines) and fit.adequate and penalty(fit) < SHOWS
    plain = fit if chance else None
    fit = fit if FRAME in found[0].names else best
    return CommonFit(fit, found, fall, m, penalty(best) < SHOWS, plain=plain)


def _searched(
    lines: Sequence[RecordHarmonics], k: float, law: Law, slips: bool
) -> tuple[WaveformFit | None, FundamentalFit | None]:
    """Return the fit to the waveforms and, where that is not adequate, the fit to the fundamentals.

    slips : whether the records are not those of a linear oscillator. A wide search is then worth its time where the
    fundamentals give no start, or where the mass rings while it sticks, so that χ² has many minima.
    """
    fit = fit_records(lines, k, law, thorough=False)
    if fit is not None and fit.adequate:
        return (of_all_stiffnesses(fit) if slips and not law.nonlinear else fit), None
    alone = fit_fundamentals(lines, k, law)
    if alone is not None and not moves(alone):
        alone = None
    ends = [fit]
    if alone is not None:
        problem = HarmonicProblem(law, tuple(lines), k)
        ends.append(fit_from(problem, problem.like(alone)))
    fits = [one for one in ends if one is not None]
    fit = min(fits, key=lambda one: one.chi_square, default=None)
    rings = fit is not None and max(one.swings for one in fit.responses) > 1.0
    if slips and (fit is None or (not fit.adequate and (alone is None or rings))):
        fit = fit_records(lines, k, law, near=fit)
    return fit, None if fit is not None and fit.adequate else alone


def with_common_fit(
    readings: Sequence[Reading], common: CommonFit, law: Law | None = None
) -> list[Reading]:
    """Return the readings with the waveforms of the fit.

    Where the waveforms do not hold, the readings have none; of the nearest oscillator they then have only the travel
    that its sticking takes.

    law : of the terms whose integrals are wanted.
    """
    wanted = () if law is None else tuple(s for s in law.terms if s not in (FRICTION, "c"))
    fit, fitted = common.fit, []
    for i, reading in enumerate(readings):
        shared, travel = None, reading.stick_travel
        if fit is not None and fit.adequate:
            shared = fit.waveforms[i]
        elif fit is not None:
            nearest = (common.fundamentals or fit).responses[i]
            travel = nearest.stick_travel if nearest.slips else math.nan
        fitted.append(replace(reading, waveform=shared, stick_travel=travel, terms=wanted))
    return fitted
