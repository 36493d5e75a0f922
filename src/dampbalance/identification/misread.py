"""Channels in a wrong unit or with a wrong sign, found by the factor with which an oscillator explains the records.

If the unit of the response or of its drive is wrong, or one transducer points the other way, their harmonics contradict
each other: the loss of the fundamental requires one ratio of the two, the higher harmonics, which only the response
has, another. Where no oscillator explains the records as read, and exactly one of the factors between units makes one
explain them within their noise, the user is asked about it. The factor is never applied: a response that is 9.81 times
too small and a drive that is 9.81 times too large are the same motion, with another F_k.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence

from ..findings.finding import UNBOUNDED, Finding
from ..fit.nuisances import with_gain
from ..fit.starts import starts
from ..fit.steady_search import fit_from, fit_quickly
from ..fit.waveforms import HarmonicProblem, WaveformFit
from ..law.law import Law
from ..records.channel import ORDERS, Channel
from ..records.record import Record
from ..records.units import DIMENSIONS, UNITS
from ..signals.mean_harmonics import Reading
from ..signals.record_harmonics import RecordHarmonics
from .causes import FRAME
from .oscillator import CommonFit

_TURN = 2.0 * math.pi  # of a velocity from an amplitude times a frequency in Hz
_SAME = 1e-3  # relative: one factor of two units
_ALIKE = 0.05  # relative: factors that records do not distinguish, as of kgf and daN
_MUCH = 100.0  # ratio of two χ²: a further departure leaves less than a factor of two units does
_NEAR = 0.1  # relative deviation of a mass: a factor of two units is farther off
_FAR = (
    30.0  # ratio of natural and drive frequency, either way: no rig is driven so far off on purpose
)
# part of the amplitudes added to errors, and evaluations, of the climb that decides whether a full fit is worth it
_SOFT, _TRIED = 0.01, 4


def misread(
    common: CommonFit, records: Sequence[Record], readings: Sequence[Reading], law: Law, k: float
) -> Iterator[Finding]:
    """Yield a finding where an oscillator explains the records with one channel in another unit, or with the other
    sign, and none explains them as read.

    common : the fit to the readings as they are.   k : N/m.
    """
    channels = *records[0].responses, records[0].excitation
    turned = all(any(w.code == "exchanged" for w in of.warnings) for of in readings)
    unlike = len(channels) > 2 or len({one.quantities for one in records}) > 1
    if unlike or readings[0].steady.base_mass is not None or _sound(common, turned):
        return
    what: dict[float, list[Finding]] = {}
    if turned:
        what[-1.0] = [Finding("turned", {"quantities": tuple(of.quantity for of in channels)})]
    for channel, power in () if turned else zip(channels, (1.0, -1.0), strict=True):
        for finding in _readings(channel):
            ratio = finding.numbers["by"] ** power
            known = next((r for r in what if abs(ratio / r - 1.0) < _SAME), ratio)
            what.setdefault(known, []).append(finding)
    lines = [reading.lines for reading in readings]
    fits = {r: _nearest([with_gain(of, r) for of in lines], k, law) for r in (1.0, *what)}
    sizes = {ratio: fit.chi_square for ratio, fit in fits.items() if fit is not None}
    best = min(sizes, key=sizes.__getitem__, default=1.0)
    rivals = [ratio for ratio in sizes if abs(ratio / best - 1.0) > _ALIKE]
    if best == 1.0 or any(_rivals(fits[ratio], fits[best]) for ratio in rivals):
        return
    fit = fits[best]
    # of exchanged channels, too, an oscillator is closer with the other sign, but does not explain them
    if fit is not None and _plausible(fit, common.mass) and (fit.adequate or not turned):
        of = {"what": tuple(what[best]), "holds": bool(fit.adequate)}
        yield Finding("misread", of, UNBOUNDED)


def _rivals(fit: WaveformFit | None, best: WaveformFit | None) -> bool:
    """Return whether a fit may be right as well as the best. If the best holds, one that holds, too, may be; if not, as
    where the records have another departure, one that is not much farther from them."""
    if fit is None or best is None:
        return False
    return fit.adequate if best.adequate else fit.chi_square < _MUCH * best.chi_square


def _sound(common: CommonFit, turned: bool) -> bool:
    """Return whether the records may be those of an oscillator of usual size, or show too little friction to decide.

    turned : whether the response leads its drive.
    """
    fit = common.fit
    if fit is None:
        return common.stuck is not None and not turned
    return common.waveforms_hold and FRAME not in common.clear and _plausible(fit, common.mass)


def _plausible(fit: WaveformFit, mass: float | None) -> bool:
    """Return whether an oscillator has a usual natural frequency and the given mass.   mass : kg, or None."""
    far = fit.natural_frequency_hz * 2.0 * math.pi / fit.lines[0].omega
    return (mass is None or abs(fit.m / mass - 1.0) < _NEAR) and 1.0 / _FAR < far < _FAR


def _readings(channel: Channel) -> Iterator[Finding]:
    """Yield a finding for each other reading of a channel, in another unit or with another factor of a velocity, with
    the factor by which it is then larger."""
    dimension = DIMENSIONS[channel.coordinate.key(channel.quantity)]
    units = [unit for unit in UNITS if unit.dimension == dimension]
    read = [unit for unit in units if math.isclose(unit.factor, abs(channel.factor))]
    for own, unit in itertools.product(read[:1], units):
        by = unit.factor / own.factor
        if abs(by - 1.0) > _ALIKE:
            of = {"unit": unit.name, "read": own.name}
            yield Finding("other unit", {"quantity": channel.quantity, "by": by, **of})
    if ORDERS.get(channel.quantity) == 1:
        for by in (_TURN, 1.0 / _TURN):
            yield Finding("other scale", {"quantity": channel.quantity, "by": by})


def _nearest(lines: Sequence[RecordHarmonics], k: float, law: Law) -> WaveformFit | None:
    """Return the oscillator closest to some records; None where none is close."""
    problem = HarmonicProblem(law, tuple(lines), k)
    for start in starts(lines, k, problem.shares)[:1]:
        near = fit_from(problem.softened(_SOFT), problem.start(start), _TRIED)
        if near is not None and near.chi_square < problem.samples:
            return fit_quickly(problem, None)
    return None
