"""One oscillator fitted to all records by maximum likelihood: where it holds, the answer, which the balance checks."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

from ..findings.finding import UNBOUNDED, Finding
from ..fit.fit import OscillatorFit
from ..fit.goodness import LinearFit, improbable, linear_fit
from ..fit.select import CLEAR, Selection, select
from ..fit.steady_search import (
    fit_from,
    fit_fundamentals,
    fit_records,
    of_all_stiffnesses,
    refit,
    rescaled,
)
from ..fit.waveforms import HarmonicProblem, WaveformFit
from ..law.law import Law
from ..law.terms import FRICTION
from ..signals.mean_harmonics import Reading
from ..signals.record_harmonics import RecordHarmonics
from ..signals.thresholds import SHOWS
from ..solver import NORMAL_95
from .answer import Answer, answer_of_fit, averaged
from .causes import FRAME, NOT_IN_ROWS, candidates
from .weighing import said_of

_DIFFER = 1.05  # ratio of two amplitudes above which friction and damping can be distinguished


@dataclass(frozen=True, eq=False)
class CommonFit:
    """One oscillator fitted to all records.

    selection : the closest oscillator and those with a further departure, weighed; None where no oscillator that slips
    is close, or a linear one explains the records.
    mass : kg, as given, or None.   mass_fits : whether the records agree with it.
    stuck : the linear oscillator, with the stiffness of a contact that only sticks, where it explains the records
    within their noise: nothing slips, or slip does not show.
    frictionless : whether the balance has no friction column: the contact sticks, or no two levels differ.
    """

    selection: Selection | None
    mass: float | None = None
    mass_fits: bool = True
    stuck: LinearFit | None = None
    frictionless: bool = False

    @classmethod
    def of(
        cls, fit: WaveformFit, mass: float | None = None, *, mass_fits: bool = True
    ) -> CommonFit:
        """Return that of a single fit, which is compared with no other."""
        keys = (*fit.law.unknowns, "rho", "m")
        return cls(select(fit, (), keys, noise=1.0), mass, mass_fits)

    @property
    def fit(self) -> WaveformFit | None:
        """The heaviest fit to the records as read: where the other frame is the heaviest model, the plain one."""
        of = self.selection
        fit: WaveformFit | None = None if of is None else of.plain if FRAME in of.names else of.fit
        return fit

    @property
    def closest(self) -> OscillatorFit:
        """The heaviest fit of all, also of the responses in the other frame."""
        assert self.selection is not None
        fit: OscillatorFit = self.selection.fit
        return fit

    @property
    def waveforms_hold(self) -> bool:
        """Whether the waveforms of the fit are those of the records, so that the onset of slip and K_z are known."""
        return self.fit is not None and self.fit.holds

    @property
    def clear(self) -> tuple[str, ...]:
        """Departures of a weight above `CLEAR`."""
        of = self.selection
        return () if of is None else tuple(name for name in of.names if of.weight(name) > CLEAR)

    @property
    def in_rows(self) -> list[str]:
        """The departures for which the answer is corrected and the rows of the balance are not."""
        of = self.selection
        if of is None:
            return []
        said = (what.code for one in said_of(of) for what in one.numbers["what"])
        return [name for name in dict.fromkeys((*of.names, *said)) if name not in NOT_IN_ROWS]

    @property
    def mass_taken(self) -> bool:
        """Whether the fit has the mass that was given, which the records know less well."""
        return self.mass is not None and self.fit is not None and self.fit.error("m") == 0.0

    @property
    def notes(self) -> tuple[Finding, ...]:
        """What limits the use of the numbers of the fit."""
        if self.selection is None:
            return ()
        fit: WaveformFit = self.selection.fit
        far = [] if fit.adequate else [Finding("far", effect=UNBOUNDED)]
        early = [] if fit.converged else [Finding("not converged", effect=UNBOUNDED)]
        none = [key for key in fit.law.unknowns if fit.value(key) <= 0.0]
        return (*far, *early, *(Finding("at its limit", {"symbol": key}) for key in none))

    @property
    def delay(self) -> tuple[float, float] | None:
        """Delay of the response that the records show and its standard error, s: fitted, or to first order."""
        fit = self.fit
        if fit is None or not self.waveforms_hold:
            return None
        if fit.parameters["delay"].free:
            return fit.value("delay"), fit.error("delay")
        shown = fit.departures.get("delay")
        return None if shown is None else (shown.value, shown.error)

    @property
    def answer(self) -> Answer | None:
        """The numbers of all models that were weighed; None where no oscillator that slips fits."""
        if self.selection is None:
            return None
        fit, delay = self.selection.fit, self.delay or (None, None)
        answer = answer_of_fit(
            fit,
            fit.law.unknowns,
            self.notes,
            misfit_of_records=fit.misfits,
            delay_s=delay[0],
            delay_standard_error_s=delay[1],
        )
        return averaged(answer, self.selection)


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
    """Return the oscillator of the records.

    The records determine the mass, often better than scales do: the fit takes a given mass only where it is known
    better than the records know it, and they agree with it.

    k : N/m.   m : kg, if it is known.   law : of the damping; default, F_k and c.
    mass_error, stiffness_error : standard uncertainties of m, kg, and of k, N/m, for the test of the mass.
    departures : whether to test departures, which takes time.
    frames : whether the response may be in another frame than stated.
    """
    law = law or Law()
    without = linear_fit(lines, k, law.terms)
    slips = improbable(without.chi_square, without.freedom, lines)
    fit, scaled = _searched(lines, k, law, slips)
    fall = 0.0 if fit is None else without.chi_square - fit.chi_square
    linear = fall < SHOWS and not slips

    def penalty(one: OscillatorFit) -> float:
        """Return the χ² that the mass given adds: the square of its difference in standard errors."""
        low, high = one.interval("m")
        error = 0.5 * (high - low) / NORMAL_95
        apart = math.hypot(error, mass_error, stiffness_error / k * one.m)
        return 0.0 if m is None or one.m == m else ((one.m - m) / apart) ** 2

    if fit is None or linear:
        stuck = linear_fit(lines, k, law.terms, m, mass_error) if linear else None
        bare = False
        if stuck is not None:
            # k itself acts where a force drives, and mω² where a base moves
            of_k = stiffness_error * max(1.0, stuck.by_mass * (m or 0.0) / k)
            stuck = stuck._replace(contact_error=math.hypot(stuck.contact_error, of_k))
            sizes = [float(abs(one.x[0])) for one in lines]
            alike = len(lines) < len(law.unknowns) or max(sizes) < _DIFFER * min(sizes)
            bare = alike or stuck.sticks is True
        return CommonFit(None, m, stuck=stuck, frictionless=bare)
    error = fit.error("m")
    given = refit(fit, given={"m": m}) if m is not None and mass_error < error else None
    # χ² rises by the square of the difference over the error of the records alone
    most = SHOWS * (1.0 + (mass_error / error) ** 2) if error else SHOWS
    fits = given is not None and given.chi_square - fit.chi_square < most
    fit = given if given is not None and fits else fit

    if not departures:
        return CommonFit.of(fit, m, mass_fits=penalty(fit) < SHOWS)
    keys = (*law.unknowns, "rho", "m")
    unsure = frames and not (fit.adequate and penalty(fit) < SHOWS)
    of = partial(candidates, penalty=penalty)
    found = select(fit, of(fit, frames=unsure), keys, noise=1.0, further=of)
    if not found.fit.adequate and scaled is not None:
        other = select(scaled, of(scaled), keys, noise=1.0, further=of)
        # a departure with which an oscillator explains the fundamentals may explain the waveforms, too
        by_weight = sorted(zip(other.weights, other.models, strict=True), key=lambda one: one[0])
        names = [((*other.departures, one.name)[0], one.fit) for _, one in by_weight]
        starts = {name: one for name, one in names if name and one is not None}
        found = (
            select(fit, of(fit, starts=starts), keys, noise=1.0, further=of) if starts else other
        )
        if not found.fit.adequate:
            found = other
        if not found.fit.adequate and (scaled := rescaled(other.fit)) is not None:
            free = scaled.parameters.held(*other.names)
            plain = fit_from(scaled.problem, free.moved(**dict.fromkeys(other.names, 0.0)))
            plain = plain or scaled
            found = select(plain, of(plain), keys, noise=1.0, further=of)
    return CommonFit(found, m, penalty(found.fit) < SHOWS)


def _searched(
    lines: Sequence[RecordHarmonics], k: float, law: Law, slips: bool
) -> tuple[WaveformFit | None, WaveformFit | None]:
    """Return the fit to the waveforms and, where that is not adequate, the one with scaled errors.

    slips : whether no linear oscillator explains the records. A wide search is then worth its time where the
    fundamentals give no start, or where the mass rings while it sticks, so that χ² has many minima.
    """
    fit = fit_records(lines, k, law, thorough=False)
    if fit is not None and fit.adequate:
        return (of_all_stiffnesses(fit) if slips and not law.nonlinear else fit), None
    scaled = fit_fundamentals(lines, k, law, fit)
    if scaled is not None:
        ends = fit, fit_from(HarmonicProblem(law, tuple(lines), k), scaled.parameters)
        fit = min(filter(None, ends), key=lambda one: one.chi_square, default=None)
    rings = fit is not None and max(one.swings for one in fit.responses) > 1.0
    if slips and (fit is None or (not fit.adequate and (scaled is None or rings))):
        fit = fit_records(lines, k, law, near=fit)
    return fit, None if fit is not None and fit.adequate else scaled


def with_common_fit(
    readings: Sequence[Reading], common: CommonFit, law: Law | None = None
) -> list[Reading]:
    """Return the readings with the waveforms of the fit; where these do not hold, with the stick travel of the closest
    oscillator alone.

    law : whose terms are integrated.
    """
    wanted = () if law is None else tuple(s for s in law.terms if s not in (FRICTION, "c"))
    fit, fitted = common.fit, []
    for i, reading in enumerate(readings):
        shared, travel = None, reading.stick_travel
        if fit is not None and fit.holds:
            shared = fit.waveforms[i]
        elif fit is not None:
            nearest = fit.responses[i]
            travel = nearest.stick_travel if nearest.slips else math.nan
        fitted.append(replace(reading, waveform=shared, stick_travel=travel, terms=wanted))
    return fitted
