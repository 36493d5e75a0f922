"""Remarks that a reader needs before using a number: notes on answers, warnings on records, and both as a list without
repetitions.

A sentence on the oscillator is given only where the fit of one oscillator to all records supports it.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from decimal import Decimal
from pathlib import PurePath

import numpy as np
from scipy import special

from ..balance import Rows
from ..fit.fundamentals import FundamentalFit
from ..fit.goodness import LinearFit
from ..fit.nuisances import with_response
from ..fit.oscillator_fit import OscillatorFit
from ..fit.steady_search import fit_records
from ..fit.waveforms import WaveformFit
from ..law.terms import FRICTION, term
from ..project.wording import (
    Remark,
    Shown,
    change_text,
    factor,
    larger_by,
    listed,
    merged,
    number_text,
    part,
    percent,
    times,
    with_unit,
)
from ..signals.checks import is_clipped
from ..signals.mean_harmonics import Reading
from ..signals.thresholds import AS_WELL, P_CAUSE, SHOWS
from ..solver import NORMAL_95, solve
from .answer import (
    FUNDAMENTALS,
    REFERENCE,
    UNBOUNDED,
    USELESS,
    Answer,
    ParameterEstimate,
    limit,
)
from .causes import CAUSES, doubts_of, hint_of, likeliest, remark_on
from .oscillator import JointFit, Microstick

_UNITS = {
    1000.0: "mm taken for m",
    100.0: "cm taken for m",
    25.4: "mm taken for inches",
    10.0: "mm taken for cm",
}


def notes_on(answer: Answer, readings: Sequence[Reading], joint: JointFit) -> Iterator[Remark]:
    """Yield what a reader must know, in addition to its own notes, before using the answer of the balance."""
    clipped = [
        f"{quantity} of {reading.steady.source}"
        for reading in readings
        for quantity, harmonics in reading.steady.channels.items()
        if is_clipped(harmonics)
    ]
    suspects = "a sign, a gain, a channel or the stiffness"
    yield from forbidden(answer.coefficients, clipped, suspects)
    if joint.frictionless:
        yield Remark("the records show neither F_k nor K_z: c is taken from W = b c")
    elif joint.stuck is not None:
        known = joint.stuck.sticks is not None
        or_sticks = (
            " if the contact slips; that it only sticks, whatever F_k is, they do not exclude: give the mass "
            "(--mass), or add records at another frequency"
        )
        bounds = [limit(s, p) for s, p in answer.coefficients.items() if term(s).symbol == FRICTION]
        yield Remark(
            f"the records show hardly any friction, and no K_z: {listed(bounds)} at 95 %{'' if known else or_sticks}",
            doubts={} if known else {s: math.inf for s in answer.coefficients if s == FRICTION},
        )
    elif not joint.waveforms_hold and not answer.notes:
        yield Remark(
            "slip onset could not be detected: the stick distance is taken from the closest fit"
            if joint.fit is not None
            else "slip onset could not be detected: the contact is taken as rigid, and F_k is too small",
            doubts=_by_half_the_stick(answer, readings) if joint.fit is not None else UNBOUNDED,
        )
        if answer.misfit > 9.0:  # χ² per degree of freedom: three times the noise
            yield Remark(
                "the residual of its rows is {} times the noise",
                factor(math.sqrt(answer.misfit)),
                doubts=by_scatter(answer.coefficients, answer.misfit),
            )
    if joint.in_rows:
        apart = {key: joint.closest.value(key) for key in answer.coefficients}
        yield Remark(
            "its rows are not corrected for the departure that the records show (see below)",
            doubts={
                s: abs(p.value / (apart[s] or math.inf) - 1.0)
                for s, p in answer.coefficients.items()
            },
        )


def by_scatter(coefficients: Mapping[str, ParameterEstimate], misfit: float) -> dict[str, float]:
    """Return by what part each coefficient may be off where the rows scatter as much as this χ² per degree of
    freedom says: its interval, as many times as wide."""
    return {symbol: math.sqrt(misfit) * p.within for symbol, p in coefficients.items()}


def _by_half_the_stick(answer: Answer, readings: Sequence[Reading]) -> dict[str, float]:
    """Return by what part each coefficient changes where the stick distance λ = 4X − a is off by half of it."""
    assert answer.balance is not None
    rows, errors = answer.balance.rows, answer.balance.errors
    weights = np.where(errors > 0.0, errors, 1.0) ** -2.0
    stick = np.array([reading.stick_travel for reading in readings])
    terms = {
        key: g + 0.5 * stick if term(key).symbol == FRICTION else g for key, g in rows.terms.items()
    }
    shifted = solve(replace(rows, terms=terms, weights=weights))
    return {
        symbol: abs(float(value) / answer.values[symbol] - 1.0)
        for symbol, value in shifted.values.items()
        if answer.values.get(symbol)
    }


def forbidden(
    coefficients: Mapping[str, ParameterEstimate], clipped: Sequence[str], suspects: str
) -> list[Remark]:
    """Return a sentence on each coefficient whose whole interval is negative, with the likely cause.

    clipped : names of clipped signals.   suspects : what else may be wrong, "a gain or the stiffness".
    """
    cause = f"{suspects} may be wrong"
    if clipped:
        cause = f"clipping is the likely cause ({listed(clipped)}); raise the measuring range"
    return [
        Remark(
            "{} = {} is negative, which physics forbids: {}",
            *(symbol, Shown(p.value, with_unit(number_text(p.value, 3), term(symbol).unit)), cause),
            doubts=UNBOUNDED,
        )
        for symbol, p in coefficients.items()
        if p.interval.high < 0.0
    ]


def on_records(readings: Sequence[Reading], joint: JointFit) -> list[Remark]:
    """Return the warnings on single records. Those that spare the fit, which has the harmonics of the drive, spare that
    to the fundamentals, too, where it leaves no more than noise."""
    alone = joint.fundamentals
    holds = alone is not None and special.chdtrc(alone.freedom, alone.chi_square) > P_CAUSE
    spared = (FUNDAMENTALS,) if holds else ()
    return [
        words.about(r.steady.source, *(spared if REFERENCE in words.spares else ()))
        for r in readings
        for words in r.warnings
    ]


def agreement(
    readings: Sequence[Reading],
    microstick: Microstick,
    joint: JointFit,
    direct: Answer,
) -> Iterator[Remark]:
    """Yield warnings on all records together: what the joint fit shows, which levels fail, where the balance by direct
    integration contradicts."""
    yield from _on_the_oscillator(readings, joint)
    if still := _numbered(reading.slips is False for reading in readings):
        yield Remark(
            f"the contact only sticks in record {still}: it takes no energy there, and the balance leaves the record "
            "out"
        )
    if joint.waveforms_hold and not microstick.resolved:
        yield Remark(
            "the records together do not resolve the onset of slip: K_z has a lower limit only; sample faster, measure "
            "acceleration, or reduce the noise",
            doubts={"K_z": math.inf},
        )
    fit = joint.fit
    if fit is not None and {"c", "c_r"} <= set(fit.law.unknowns):
        yield Remark(
            f"c and c_r together cannot be distinguished from a skew of the channels: if the response lags by 1 µs, "
            f"c_r is {number_text(1e-6 * fit.k, 2)} N s/m too small and c as much too large",
            doubts={"c": math.inf, "c_r": math.inf},
        )
    if fit is not None and joint.waveforms_hold and not joint.in_rows:
        yield from contradiction(direct, fit)
    rows = None if direct.balance is None else direct.balance.rows
    # errors are fifty times those of a single unknown
    if rows is not None and rows.usable.sum() > 1 and _sine(rows) < 0.02:
        coefficients = list(direct.coefficients)
        yield Remark(
            f"the levels are so alike that {listed(coefficients)} can hardly be distinguished by the balance: add "
            "a record at a much higher or lower amplitude",
            doubts=dict.fromkeys([*coefficients, "K_z"], math.inf),
        )


def _numbered(which: Iterable[bool]) -> str:
    """Return numbers of the records for which something holds: "1, 3"."""
    return ", ".join(str(i) for i, holds in enumerate(which, 1) if holds)


def _on_the_oscillator(readings: Sequence[Reading], joint: JointFit) -> Iterator[Remark]:
    """Yield warnings from the joint fit."""
    if joint.stuck is not None:
        contact = {
            True: "the contact only sticks, and F_k and K_z cannot be determined; raise the excitation",
            False: "hardly any friction shows; lower levels show more of what there is",
            None: "the contact only sticks, or there is no friction, and F_k and K_z cannot be determined; raise the "
            "excitation",
        }[joint.stuck.sticks]
        yield Remark(f"the records are those of a linear oscillator within their noise: {contact}")
        yield from _too_stiff(readings, joint.stuck, joint.mass)
        return
    yield from _wrong_unit(readings, joint)
    fit, alone = joint.fit, joint.fundamentals
    if joint.explained:
        yield remark_on(joint.explained, joint.fall)
    if joint.hinted and fit is not None:
        yield hint_of(joint.hinted, joint.fall, fit)
    if joint.mass is not None and not joint.mass_fits:
        by_force = any("force" in reading.steady.channels for reading in readings)
        yield on_mass(joint.closest, joint.mass, by_force)
    if fit is None:
        yield Remark(
            "no oscillator with this stiffness and a friction contact slips and responds like the records: check the "
            "stiffness, the signs, the units and the order of the channels"
        )
    elif not fit.adequate and not joint.explained:
        yield _none_fits(readings, fit, alone)


def _too_stiff(
    readings: Sequence[Reading], stuck: LinearFit, mass: float | None
) -> Iterator[Remark]:
    """Yield a sentence where a contact that only sticks would have a stiffness below zero: the stiffness that is given
    is too high by as much at least, as a contact adds to that of the spring."""
    if stuck.contact >= -math.sqrt(SHOWS) * stuck.contact_error:
        return
    steady = readings[0].steady
    of_base = "force" not in steady.channels and steady.base_mass is None and mass is not None
    # a base that moves tells k/m, a force k itself
    left = (mass or 0.0) * stuck.by_mass if of_base else stuck.k + stuck.contact
    too_high = -stuck.contact / left if left > 0.0 else math.inf
    yield Remark(
        "k is stated at least {} too high for the records, as a contact can only add to it: check stiffness, mass, "
        "gains and units",
        larger_by(too_high) if left > 0.0 else "a multiple of itself",
        doubts={"": too_high},
    )


def _none_fits(
    readings: Sequence[Reading], fit: WaveformFit, alone: FundamentalFit | None
) -> Remark:
    """Return the sentence on records that no oscillator explains, whatever departure it has.

    alone : the fit to their fundamentals, whose numbers the likeliest departure moves to first order.
    """
    likely = ""
    doubts: Mapping[str, float] = {}
    if cause := likeliest(fit):
        share = min(1.0, cause.size**2 / (fit.chi_square - fit.freedom))
        words = CAUSES[cause.symbol].sized(cause.value, cause.error)
        likely = (
            f"; the likeliest of the causes tested is {words}, which explains {part(share)} of that"
        )
        # the numbers are off by the cause of most of it
        if share > 0.5 and alone is not None and not alone.has(cause.symbol):
            doubts = doubts_of(cause, fit)
    worst = readings[int(np.argmax(fit.misfits))].steady.source
    return Remark(
        "the records are not those of one mass on a spring, a damper and one friction contact: the closest fit of "
        f"{fit.evaluations} trials has a residual {times(math.sqrt(fit.misfit))} the noise, largest in {worst}{likely}",
        doubts=doubts,
    )


def on_mass(fit: OscillatorFit, mass: float, by_force: bool = False) -> Remark:
    """Return the warning that a mass is not that of the records, and that each number may be off by as much.

    m, c, k, K_z and F_k times a number are an oscillator of the same motion: where the mass is right, the stiffness is
    likely wrong, and all numbers by as much.

    mass : kg, as given.   by_force : whether a load cell measures what drives, and feels what is between.
    """
    meant = _mistaken_unit(mass / fit.m, fit.k, mass)
    if by_force and 0.5 < mass / fit.m < 1.0:
        meant = "does a fixture above the load cell move along (--fixture-mass)? Otherwise "
    return Remark(
        f"the {of_masses(fit.m, mass)}, more than their uncertainties allow: {meant}check mass, stiffness, gains and "
        "units, as an error in one may shift all numbers by as much",
        doubts={"": abs(mass / fit.m - 1.0)},
    )


def _mistaken_unit(ratio: float, k: float, mass: float) -> str:
    """Return a question about the unit of stiffness or mass where their ratio to those of the records is that of two
    units; else nothing."""
    asked = [
        f"{name} {number_text(value, 3)} {unit}"
        for (name, unit), factor in _MISTAKEN.items()
        for value in [k if name == "k =" else mass]
        if abs(ratio / factor - 1.0) < _CLOSE
    ]
    return f"did you mean {listed(asked, 'or')}? Otherwise " if asked else ""


_CLOSE = 0.03  # relative: what a gain and a mass that nobody weighed leave between two units
_MISTAKEN = {  # quantity and its unit → how many times the given number is too large a mass, or too small a stiffness
    ("k =", "N/mm"): 1000.0,
    ("m =", "g"): 1000.0,
    ("k =", "N/cm"): 100.0,
    ("k =", "kgf/m"): 9.80665,
    ("m =", "N"): 9.80665,
    ("k =", "kgf/mm"): 9806.65,
    ("k =", "lbf/in"): 175.127,
    ("k =", "lbf/ft"): 14.5939,
    ("m =", "lb"): 2.20462,
    ("m =", "oz"): 35.274,
}


def of_masses(implied: float, given: float) -> str:
    """Return records imply 3.1000 kg, you gave 3.098 kg (0.06 % less)"""
    ratio, off = given / implied, given / implied - 1.0
    if not 0.5 < ratio < 2.0:
        how = f"{max(ratio, 1.0 / ratio):.3g} times as {'much' if ratio > 1.0 else 'little'}"
        return f"records imply {number_text(implied, 4)} kg, you gave {number_text(given, 4)} kg ({how})"
    shown = 1 - math.floor(math.log10(abs(given - implied))) if off else 4
    written_with = -int(Decimal(f"{given:.6g}").as_tuple().exponent)
    size = f"{100.0 * abs(off):.2f} %" if abs(off) >= 1e-4 else percent(off)
    return (
        f"records imply {implied:.{max(written_with + 1, shown, 0)}f} kg, you gave {given:.6g} kg "
        f"({size} {'less' if off < 0.0 else 'more'})"
    )


def _wrong_unit(readings: Sequence[Reading], joint: JointFit) -> Iterator[Remark]:
    """Yield a question about the unit of a channel where the mass moves much more or less than the base, and another
    unit of one of them explains the records as well as any oscillator does."""
    lines, fit = [reading.lines for reading in readings], joint.fit
    gains = [float(abs(one.x[0])) / one.Y for one in lines]
    # of X/Y, or its inverse, to doubt units of records that no oscillator explains; of others, 300 takes a Q of 300 or
    # 17 times the natural frequency
    limit = 300.0 if joint.linear or (fit is not None and fit.adequate) else 100.0
    large = any(gain > limit for gain in gains)
    if not (large or any(gain < 1.0 / limit for gain in gains)):
        return
    steady, law = readings[0].steady, None if fit is None else fit.law
    for size, words in _UNITS.items():
        scaled = [with_response(one, 1.0 / size if large else size) for one in lines]
        other = fit_records(scaled, steady.k, law, thorough=False)
        if other is None or not other.adequate:
            continue
        if fit is None or other.chi_square < fit.chi_square + AS_WELL:
            drive = "the force over the stiffness" if "force" in steady.channels else "the base"
            yield Remark(
                f"the mass moves {max(gains) if large else min(gains):.3g} times as far as {drive}; {size:g} times "
                f"{'less' if large else 'more'} would fit an oscillator as well: is the unit of one channel wrong "
                f"({words})?",
                doubts={"": math.inf},
            )
            return


def contradiction(
    answer: Answer, fit: OscillatorFit, least: float = 4e-7, wider: float = 1.0
) -> Iterator[Remark]:
    """Yield a sentence where the balance contradicts the fit to all records by more than their errors allow.

    least : relative difference that counts, above the errors of the balance itself: by default those of rounding in
    integrals of exact waveforms.
    wider : factor of the errors of the balance.
    """
    parts = {}
    for symbol, own in answer.coefficients.items():
        of_fit, error = fit.value(symbol), wider * own.standard_error
        # the fit uses all that the balance uses: the variance of their difference is that of their variances
        of_both = math.sqrt(max(error**2 - fit.error(symbol) ** 2, 0.0))
        most = math.sqrt(SHOWS)
        allowed = max(most * of_both, 0.5 * most * error, least * abs(of_fit))
        if abs(own.value - of_fit) > allowed and of_fit:
            parts[symbol] = (
                f"{symbol} by {change_text(of_fit, own.value - of_fit, term(symbol).unit)}"
            )
    if parts:
        yield Remark(
            "the energy balance and the fit of one oscillator to all records differ by more than their errors allow: "
            f"{' and '.join(parts.values())}",
            doubts={
                symbol: abs(answer.values[symbol] / fit.value(symbol) - 1.0) for symbol in parts
            },
        )


def _sine(rows: Rows) -> float:
    """Return the smallest sine of the angle that a column of the balance makes with those before it, each row counted
    by the parts of its work: of the largest motion alone, all small ones would look alike."""
    used = rows.usable & (rows.W != 0.0)
    columns = [g[used] / rows.W[used] for s, g in rows.terms.items() if s not in rows.given]
    unit = np.column_stack([g / np.linalg.norm(g) for g in columns])
    return float(np.min(np.abs(np.diag(np.linalg.qr(unit)[1]))))


def doubted(answers: Mapping[str, Answer], warnings: Sequence[Remark]) -> dict[str, Answer]:
    """Return the answers with their intervals widened by what their notes and the warnings can do to each number, and
    with a doubt where that is more than the interval and than `USELESS`, or is not known."""
    return {
        name: _doubted(answer, [*(w for w in warnings if name not in w.spares), *answer.notes])
        for name, answer in answers.items()
    }


def _doubted(answer: Answer, remarks: Iterable[Remark]) -> Answer:
    """Return the answer with what remarks can do to its numbers."""
    kinds = _by_kind(remark for remark in remarks if remark.doubts)
    parameters = {s: _shifted(s, p, kinds) for s, p in answer.parameters.items()}
    # which way a shift goes is not known: it correlates nothing
    pairs = zip(parameters.values(), answer.parameters.values(), strict=True)
    added = np.diag([p.standard_error**2 - own.standard_error**2 for p, own in pairs])
    return replace(
        answer, parameters=parameters, covariance=answer.covariance + np.nan_to_num(added)
    )


def _shifted(symbol: str, p: ParameterEstimate, kinds: Sequence[list[Remark]]) -> ParameterEstimate:
    """Return a number with what remarks can do to it: the largest shift of each kind, all kinds in quadrature."""
    shifts = [max(r.doubts.get(symbol, r.doubts.get("", 0.0)) for r in of) for of in kinds]
    shifts = [math.inf if math.isnan(shift) else shift for shift in shifts]
    total = math.hypot(*shifts)
    bounded = total < 1.0  # what may change a number by all of it bounds nothing
    reasons = [p.doubt] if p.doubt else []
    if not (bounded and total <= max(USELESS, p.within)):
        # those that have no bound, or the one that does most
        worst = max(shifts)
        reasons += [merged(of) for of, shift in zip(kinds, shifts, strict=True) if shift == worst]
    wider = p.wider(total * abs(p.value) / NORMAL_95) if bounded else p
    return replace(wider, doubt="; ".join(reasons), bounded=bounded and p.bounded)


# --- both as a list without repetitions -----------------------------------------------------------

_MOST_NAMES = 6  # of records in a sentence


@dataclass(frozen=True, slots=True)
class Limit:
    """One thing that limits the answers.

    kind : "records", "approaches" or "all": what it concerns.   of : their names; () for all records together.
    words : what it is, how much it is, and what helps; a number that differs among them as "low to high".
    """

    kind: str
    of: tuple[str, ...]
    words: str


def limits(answers: Mapping[str, Answer], warnings: Sequence[Remark]) -> list[Limit]:
    """Return what limits the answers, each thing once, beginning with what may change a number most; of equal effect,
    notes on answers come before warnings on records and on all of them.

    Sentences that differ only in their numbers become one, with the range of each number.
    """
    notes = [note.about(str(name)) for name, answer in answers.items() for note in answer.notes]
    of_records = [remark for remark in warnings if remark.source]
    gathered = [
        (Limit(kind, tuple(dict.fromkeys(one.source for one in group)), merged(group)), group)
        for kind, remarks in (("approaches", notes), ("records", of_records))
        for group in _by_kind(remarks)
    ]
    gathered += [(Limit("all", (), one.words), [one]) for one in warnings if not one.source]
    return [limit for limit, group in sorted(gathered, key=lambda of: -_effect(of[1]))]


def _effect(remarks: Iterable[Remark]) -> float:
    """Return the part of itself by which what remarks say may change a number most; infinite where that is not
    known."""
    shifts = [shift for remark in remarks for shift in remark.doubts.values()]
    return max((math.inf if math.isnan(shift) else shift for shift in shifts), default=0.0)


def _by_kind(remarks: Iterable[Remark]) -> list[list[Remark]]:
    """Return remarks that say the same put together."""
    alike: dict[tuple[str, ...], list[Remark]] = {}
    for remark in remarks:
        alike.setdefault(remark.kind, []).append(remark)
    return list(alike.values())


def in_a_sentence(limit: Limit, sources: Sequence[str]) -> str:
    """Return a limit as one sentence that names what it concerns.   sources : of all records."""
    if not limit.of:
        return limit.words
    named = listed(limit.of)
    if limit.kind == "records" and len(limit.of) == len(sources) > 1:
        named = f"all {len(sources)} records"
    elif limit.kind == "records":
        names = [PurePath(source).name for source in sources]
        short = dict(zip(sources, names, strict=True)) if len(set(names)) == len(names) else {}
        own = [short.get(source, source) for source in limit.of]
        named = listed(own)
        if len(own) > _MOST_NAMES:
            named = f"{len(own)} of {len(sources)} records ({', '.join(own[: _MOST_NAMES - 1])} …)"
    return f"{named}: {limit.words}"
