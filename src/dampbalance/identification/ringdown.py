"""F_k, c and K_z from free decays: rows of half cycles, weighted with their covariance, beside the fit of all samples.

Every half cycle between turns gives a row a F_k + b c = W (`reading/ringdown_rows.py`). Neighbouring rows share a turn,
and all share the rest position of the spring: rows are made independent by the root of their covariance before they are
solved.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ..arguments import number
from ..arrays import Array
from ..balance import TERMS, Rows
from ..project.wording import times, visible
from ..reading.cycles import clipped
from ..reading.frequency import stands_still
from ..reading.one_thread import one_thread
from ..reading.ringdown_bursts import NoDecay, Signal, noise_of
from ..reading.ringdown_fit import RingFit, fit_stretches, with_noise_of
from ..reading.ringdown_joint import fit_all
from ..reading.ringdown_rows import RingRows, W, rows_of
from ..reading.ringdown_starts import stretches_of
from ..reading.sampling import evenly_sampled
from ..records.measurement import EXCITATIONS, RESPONSES, Channel, Measurement
from ..solver import NORMAL_95, solve
from .notes import forbidden
from .result import Interval, ParameterEstimate

BALANCE = "balance"
"""Name of the one approach to free decays."""

_ORDERS = {quantity: order for order, quantity in enumerate(RESPONSES)}
_CHANCE = 1e-4  # probability of a misfit in noise, below which there is another reason
_MASS_OFF = 4.0  # standard errors
_FEWEST, _LOOSE = (
    2,
    1e-2,
)  # half cycles, and K_z/k, below which a motion that does not fit tells of no contact
_NOTHING = ParameterEstimate(math.nan, math.nan, math.nan, Interval(math.nan, math.nan))


@dataclass(frozen=True, eq=False)
class RingDown:
    """What free decays tell.

    k : N/m.   fit : of one oscillator to all samples, the yardstick.   rows : of the balance.
    coefficients : F_k and c of the rows, K_z of the fit, by symbol.   correlation : of the errors of F_k and c.
    misfit : χ² of the rows about their solution per degree of freedom; NaN where there are no more rows than unknowns.
    freedom : degrees of freedom.   mass_given : whether the mass was.
    sources : of the records.   notes : what a reader of the balance must know.   fit_notes : and of the fit.
    """

    k: float
    fit: RingFit
    rows: RingRows
    coefficients: Mapping[str, ParameterEstimate]
    correlation: float
    misfit: float
    freedom: int
    mass_given: bool
    sources: tuple[str, ...]
    notes: tuple[str, ...]
    fit_notes: tuple[str, ...]
    warnings: tuple[str, ...]

    @property
    def of_fit(self) -> dict[str, ParameterEstimate]:
        """What the fit of all samples identifies, by symbol."""
        found = {}
        for symbol in TERMS:
            value, error = float(getattr(self.fit, symbol)), self.fit.error(symbol)
            found[symbol] = _estimate(value, error)
        return {**found, "K_z": _stiffness(self.fit)}


@one_thread
def identify_ring_downs(
    records: Sequence[Measurement], k: float, *, mass: float | None = None
) -> RingDown:
    """F_k, c and K_z from records of free decays, one or more.

    k : stiffness, N/m.   mass : kg, if it is known.

    Raises ValueError for a stiffness or a mass that is not positive, a record whose drive moves, one without a decay
    that slips, and a channel with a filter.
    """
    number("stiffness", k)
    if mass is not None:
        number("mass", mass)
    fits: list[RingFit] = []
    warnings: list[str] = []
    offsets = 0
    for record in records:
        if record.driven and not stands_still(record.excitation.values):
            raise ValueError(
                f"{record.source}: {visible(record.excitation.name)} moves: this is no free decay, and forced records "
                "and free decays are not identified together"
            )
        said: list[str] = []
        signals = [_signal(record, channel, said) for channel in record.responses]
        warnings += [f"{record.source}: {words}" for words in said]
        numbers = range(offsets, offsets + len(signals))
        try:
            found = stretches_of(record.source, signals, k, numbers)
        except NoDecay as error:
            raise ValueError(f"{record.source}: {_unclear(record)}: {error}") from None
        if not found:
            raise ValueError(
                f"{record.source}: {_unclear(record)}: what moves in it is not the motion of a mass on a spring of "
                f"{k:g} N/m with friction; give the record from the release or the blow on"
            )
        offsets += len(signals)
        fits += found
    found_fit, left_out = fit_all(fits, offsets)
    if found_fit is None:
        raise ValueError(f"{records[0].source}: no oscillator moves like its free decays")
    warnings += [
        f"{one.source}: what moves from {one.start:.4g} s to {one.end:.4g} s is no free decay of this oscillator, and "
        "is left out"
        for one in left_out
    ]
    fit = with_noise_of(found_fit)
    if mass is not None:
        fit = _with_mass(fit, mass, warnings)
    rows = rows_of(fit)
    if not fit.adequate and (rows.halves < _FEWEST or fit.K_z < _LOOSE * k):
        raise ValueError(
            f"{', '.join(dict.fromkeys(one.source for one in fit.stretches))}: what moves in it is no free decay of a "
            f"mass on a spring of {k:g} N/m with a friction contact: the motion of the nearest one shows "
            f"{rows.halves} half cycle{'s' * (rows.halves != 1)} that slip{'s' * (rows.halves == 1)} and leaves "
            f"{times(math.sqrt(fit.misfit))} the noise; is the mass still driven, or is its frequency or its gain not "
            "constant? Give the record from the release or the blow on"
        )
    return _solved(fit, rows, tuple(r.source for r in records), mass is not None, warnings)


def _unclear(record: Measurement) -> str:
    """What there is to say of a record without a decay."""
    if record.driven:
        return f"{visible(record.excitation.name)} stands still, and no free decay was found"
    return f"nothing drives it (one of {', '.join(EXCITATIONS)} would), and no free decay was found"


def _signal(record: Measurement, channel: Channel, warnings: list[str]) -> Signal:
    """A channel of the mass, evenly sampled and with what is known of its gain and delay taken off."""
    correction = channel.correction
    channel = evenly_sampled(channel, record.source, warnings)
    t, values = channel.t, channel.values
    if correction is not None:
        if correction.low_pass or correction.high_pass:
            raise ValueError(
                f"{record.source}: {visible(channel.name)} has a filter in its mapping, which cannot be taken off a "
                "free decay; give the channel as it was before the filter"
            )
        t, values = t - correction.delay, values / correction.gain
    return Signal(channel.quantity, _ORDERS[channel.quantity], t, values, noise_of(values))


def _with_mass(fit: RingFit, mass: float, warnings: list[str]) -> RingFit:
    """The fit with the mass given, unless the decays contradict it."""
    off = (fit.m - mass) / fit.error("m")
    start = fit.point.copy()
    start[3] = mass
    again = fit_stretches(fit.stretches, fit.k, start, given={3}) if abs(off) < _MASS_OFF else None
    if again is None:
        warnings.append(
            f"the mass given, {mass:g} kg, is not that of these decays, {fit.m:.6g} ± {fit.error('m'):.2g} kg, and is "
            "left out: a gain, a unit or the stiffness may be wrong"
        )
        return fit
    return again


def _solved(
    fit: RingFit, rows: RingRows, sources: tuple[str, ...], mass_given: bool, warnings: list[str]
) -> RingDown:
    """The rows solved, with what there is to say."""
    from scipy import special  # slow to import

    found, covariance, misfit, freedom = _least_squares(fit, rows)
    notes, fit_notes = [], []
    if not fit.adequate:
        reason = (
            f"the decays are not those of one mass on a spring, a damper and one friction contact within white noise: "
            f"what is left is {fit.misfit:.3g} times as large as noise would leave it over a {_BIN} of a cycle"
        )
        notes.append(reason)
        fit_notes.append(reason)
    if freedom > 0 and special.chdtrc(freedom, misfit * freedom) < _CHANCE:
        notes.append(f"the half cycles do not share one F_k and c: χ² is {misfit:.3g} per row")
    halves = rows.halves
    if not found:
        notes.append(
            f"{halves} half cycle{'s' * (halves != 1)} that slip{'s' * (halves == 1)} do not tell F_k and c apart: "
            "start the decay higher, or give more of them"
        )
    if abs(fit.F_k) < NORMAL_95 * fit.error("F_k"):
        words = (
            "no friction shows beside the damping: if the contact sticks all the time, c belongs to the stiffness "
            "k + K_z, and is 1 + K_z/k times as large"
        )
        notes.append(words)
        fit_notes.append(words)
    errors = {symbol: math.sqrt(covariance[i, i]) for i, symbol in enumerate(found)}
    known = {s: _estimate(found[s], errors[s]) for s in TERMS if s in found}
    cut_off = {
        f"{signal.quantity} of {one.source}": f"{one.source}: {signal.quantity} is clipped: several samples hold its "
        "extreme value; swings are too small; raise the measuring range"
        for one in fit.stretches
        for signal in one.signals
        if clipped(signal.values)
    }
    warnings = [*warnings, *cut_off.values()]
    notes += forbidden(known, list(cut_off), "the drive, a hand on the mass, a gain or a filter")
    estimates = {s: known.get(s, _NOTHING) for s in TERMS} | {"K_z": _stiffness(fit)}
    correlation = float(covariance[0, 1]) / (errors["F_k"] * errors["c"]) if known else math.nan
    return RingDown(
        k=fit.k,
        fit=fit,
        rows=rows,
        coefficients=estimates,
        correlation=correlation,
        misfit=misfit,
        freedom=freedom,
        mass_given=mass_given,
        sources=sources,
        notes=tuple(notes),
        fit_notes=tuple(fit_notes),
        warnings=tuple(warnings),
    )


_BIN = "twelfth"


def _least_squares(fit: RingFit, rows: RingRows) -> tuple[dict[str, float], Array, float, int]:
    """(F_k and c by symbol, their covariance, χ² per degree of freedom, degrees of freedom)."""
    nothing: dict[str, float] = {}
    count = len(rows.columns)
    if not count:
        return nothing, np.empty((0, 0)), math.nan, 0
    scale = np.sqrt(np.diag(rows.covariance))
    scale = np.where(scale > 0.0, scale, 1.0)
    correlations = rows.covariance / np.outer(scale, scale)
    # rows that the same samples make may nearly be one
    values, vectors = np.linalg.eigh(correlations)
    whitening = (vectors / np.sqrt(np.maximum(values, 1e-10 * values[-1]))).T / scale
    white = Rows(
        {name: whitening @ g for name, g in rows.terms.items()}, whitening @ rows.columns[:, W]
    )
    estimate = solve(white)
    if math.isnan(estimate.residual):
        return nothing, np.empty((0, 0)), math.nan, 0
    design = np.column_stack(list(white.terms.values()))
    length = np.linalg.norm(design, axis=0)
    covariance = np.linalg.inv((design / length).T @ (design / length)) / np.outer(length, length)
    found = {name: float(value) for name, value in estimate.values.items()}
    freedom = count - len(found)
    left = white.misfit(found)
    misfit = float(left @ left) / freedom if freedom > 0 else math.nan
    return found, covariance, misfit, freedom


def _estimate(value: float, error: float) -> ParameterEstimate:
    return ParameterEstimate(
        value, error, math.nan, Interval(value - NORMAL_95 * error, value + NORMAL_95 * error)
    )


def _stiffness(fit: RingFit) -> ParameterEstimate:
    """K_z, with the interval of ρ."""
    if fit.rigid:
        return ParameterEstimate(math.inf, math.inf, math.nan, Interval(*fit.K_z_interval))
    error = 2.0 * fit.K_z**1.5 * fit.error("rho")
    return ParameterEstimate(fit.K_z, error, math.nan, Interval(*fit.K_z_interval))
