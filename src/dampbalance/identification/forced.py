"""F_k, c and K_z from measured responses at several levels, with standard errors and intervals.

Where the fit of one oscillator to all records (`oscillator.py`) holds, it is the answer and the balance checks it;
elsewhere the balance is the answer. Each response gives one row a F_k + b c = W of the energy balance (6). Rows of
different frequencies are solved together, since neither F_k nor c depends on the frequency. They are weighted by the
inverse variance of their misfit; Eq. (9) as published weights all rows alike.

The onset of slip comes from the waveforms of the fitted oscillator. Where no oscillator has the waveforms of the
records, the onset and K_z are unknown: the balance, by direct integration, then takes a = 4X − λ with the stick travel
λ of the closest oscillator, a small part of 4X if the contact is stiff. A level that does not slip has no row; where
none slips, F_k is unknown, and W = b c gives c.

Errors are those of the jackknife: the balance is solved again without each group of cycles of each record in turn.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from typing import TYPE_CHECKING, Any, ClassVar, Literal, Never

import numpy as np

from ..arguments import NUMBERS, number
from ..arrays import Array
from ..features import FEATURE_COLUMNS, Features
from ..findings.finding import UNBOUNDED, Finding
from ..fit.multistart import Trail
from ..fit.waveforms import WaveformFit
from ..law.law import Law, law_of
from ..law.terms import FRICTION, term
from ..project.options import Stated, options_of, with_options
from ..records.channel import ABSOLUTE, RELATIVE
from ..records.mapping import MappingLike
from ..records.record import Record
from ..signals.mean_harmonics import Means, Reading
from ..signals.one_thread import one_thread
from .answer import DIRECT, REFERENCE, UNKNOWN, Answer, ParameterEstimate, doubted
from .balance_check import compared, notes_on
from .balance_rows import as_answer, features_of, rows_of, solved_again, solved_forced
from .diagnosis import agreement, not_in_rows, on_records
from .law_comparison import compare_laws
from .level import Column, Level
from .loading import load, require_different_levels, unclipped
from .misread import misread
from .oscillator import CommonFit, common_fit, with_common_fit
from .request import read_request, with_stiffness_by_mass
from .result import Picture, Result
from .rigs import Masses, masses_of, of_a_mount, require_driven_by, require_possible
from .screen import implied
from .sensitivities import Fault
from .stated import with_stated_uncertainties
from .weighing import weighed_of

if TYPE_CHECKING:
    import pandas as pd

    from ..records.measured import RecordLike


@dataclass(frozen=True, eq=False, repr=False)
class ForcedBasis:
    """What the answers to records of steady responses rest on.

    law : the damping law whose coefficients are identified.
    readings : harmonics and features of each record.
    common : the fit of one oscillator to all records.
    features : of the records, (n,), with the onset of slip of that oscillator.
    """

    law: Law
    readings: tuple[Reading, ...]
    common: CommonFit
    features: Features

    kind: ClassVar[str] = "forced"
    mass_tests: ClassVar[bool] = True
    columns: ClassVar[Mapping[str, Column]] = {}

    def document(self, found: Result[Any]) -> dict[str, Any]:
        """Return the microstick line that all records share and the features of each record."""
        features, columns = self.features, FEATURE_COLUMNS.items()
        return {
            "microstick": microstick_of(self.fit if self.common.waveforms_hold else None),
            "records": [
                {
                    **{"record": of.source, "frequency_Hz": of.frequency_hz},
                    "frequency_standard_error_Hz": of.omega_standard_error / (2.0 * math.pi),
                    **{"cycles": of.cycles, "highest_harmonic": of.bandwidth},
                    **{"noise_rms": of.noise_rms, "slips": reading.slips},
                    "features": {c: getattr(features, n)[i] for n, c in columns},
                    "standard_errors": {c: reading.standard_errors[n] for n, c in columns},
                }
                for i, reading in enumerate(self.readings)
                for of in [reading.steady]
            ],
        }

    def levels(self, found: Result[Any]) -> list[Level]:
        """Return amplitude, input work and friction loss of a cycle of each record."""
        of, values = self.features, {**self.law.given, **found.values}
        levels = []
        for i, reading in enumerate(self.readings):
            F_k = values.get(self.law.key(FRICTION, i), math.nan)
            X, W, a = (float(numbers[i]) for numbers in (of.X, of.W, of.a))
            levels.append(Level(reading.steady.source, X, reading.steady.omega, W, F_k * a))
        return levels

    def with_fault(self, found: Result[Any], name: str, fault: Fault) -> dict[str, float]:
        """Return the numbers of an answer from harmonics with a fault: the fit, where it holds, follows to first
        order; the rows of the balance are read and solved again.

        m, c, k, K_z and F_k, all times the same number, are an oscillator of the same motion; eta is relative to k.
        """
        common, k = self.common, 1.0 + fault.stiffness
        means = [_with_fault(reading, fault) for reading in self.readings]
        fit = common.fit if common.waveforms_hold or name == REFERENCE else None
        moved = None if fit is None else _moved(fit, self.readings, means)
        if fit is not None and moved is not None and common.mass_taken:
            # a mass given too large acts like a k too small
            moved += (fault.mass - fault.stiffness) * _by_mass(fit)
        balance = found.estimates[name].balance if name in found.estimates else None
        if balance is not None:
            of = features_of(self.readings, means, moved)[:, 0]
            rows = rows_of(of, self.law, found.k, frictionless=common.frictionless)
            rows = replace(rows, given=_scaled(rows.given, 1.0 / k))
            return _scaled(solved_again(rows, balance.errors), k)
        if fit is None or moved is None:
            return {}
        by = dict(zip(fit.parameters.keys, moved[:, 0].tolist(), strict=False))
        values = {key: fit.value(key) + by[key] for key in (*fit.law.unknowns, "m")}
        if fit.rho:  # K_z = ρ^{−2}
            values["K_z"] = (fit.rho - 2.0 * by["rho"]) / fit.rho**3
        return _scaled(values, k)

    def pictures(self, found: Result[Any]) -> dict[str, Picture]:
        """Return the records folded onto one cycle, the friction force against displacement, and the rows of the
        balance."""
        from . import pictures as drawn  # slow to import

        two = set(self.law.keys) == {FRICTION, "c"}
        return {
            "cycles": Picture(drawn.cycles, (found.records, self.readings, self.fit)),
            "friction": Picture(drawn.friction, (found.records, _loops(found), self.fit)),
            "balance": Picture(drawn.balance, (found.approaches, two)),
        }

    @property
    def fit(self) -> WaveformFit | None:
        """The fit of the waveforms, where they show friction."""
        return self.common.fit


def microstick_of(fit: WaveformFit | None) -> dict[str, Any]:
    """Return the length of the microstick line X + X_s = 2F_k/K_z (10), m, whether its root exceeds zero at 95 %, and
    an upper bound at 97.5 %; NaN unless a fit has the waveforms of the records."""
    length = error = low = high = math.nan
    if fit is not None:
        forces, (low, high) = fit.law.keys_of(FRICTION), fit.interval("rho")
        length = 2.0 * fit.F_k * fit.rho**2
        slopes = np.array(
            [2.0 * fit.rho**2 / len(forces)] * len(forces) + [4.0 * fit.F_k * fit.rho]
        )
        error = math.sqrt(slopes @ fit.covariance_of(*forces, "rho") @ slopes)
    return {
        "length_m": length,
        "standard_error_m": error,
        "resolved": low > 0.0,
        "upper_bound_m": math.nan if fit is None else 2.0 * fit.F_k * high**2,
    }


def friction_loops(
    found: Result[ForcedBasis], mass: float | None = None
) -> dict[str, pd.DataFrame]:
    """Return the friction force over the averaged cycle of each forced record, by its name.

        f = k(y − x) − mẍ − Σ p_j h_j(ẋ, ẏ)

    Use it to plot loops, and to fit a friction law of your own to them. The p_j are the other coefficients of the law,
    as identified or given. Columns: phase_rad (0 at the peak of the base), x_m, v_m_per_s and f_N. Displacements are
    deviations from their mean over the cycle, so that f lacks a constant, which no record determines.

    found : the result of forced records.
    mass : kg; default, that of the fit. Without a fit it is ∮ k(y − x)ẍ dt / ∮ ẍ² dt, exact for a rigid contact:
    neither a force of constant size against ẋ nor one in proportion to ẋ correlates with ẍ over a cycle.

    >>> import math
    >>> from dampbalance import BaseMotion, Oscillator, friction_loops, identify, measured_orbit, steady_orbit
    >>> osc = Oscillator(m=2.42, c=90.0, k=2310.0, K_z=208000.0, F_k=1.28)
    >>> motions = [BaseMotion(Y=Y, omega=2 * math.pi * 3.5) for Y in (0.004, 0.008)]
    >>> records = [
    ...     measured_orbit(steady_orbit(osc, one), rate_hz=1000.0, cycles=20.0) for one in motions
    ... ]
    >>> loop, _ = friction_loops(identify(records, stiffness=2310.0)).values()
    >>> round(float(loop["f_N"].max()), 1)
    1.3
    """
    import pandas as pd  # slow to import

    pairs = zip(found.sources, _loops(found, mass), strict=True)
    return {name: pd.DataFrame(of).rename(columns=found.coordinate.key) for name, of in pairs}


def _loops(found: Result[ForcedBasis], mass: float | None = None) -> list[dict[str, Array]]:
    """Return the columns of `friction_loops` for each record."""
    law, fit, loops = found.basis.law, found.basis.fit, []
    values = {**found.values, **law.given}
    for i, reading in enumerate(found.basis.readings):
        cycle, omega = reading.averaged_cycle(), reading.steady.omega
        x, v, w, acceleration = (cycle[name] for name in ("x", "v", "w", "acceleration"))
        f = found.k * (cycle["y"] - x)
        m = f @ acceleration / (acceleration @ acceleration) if fit is None else fit.m
        f = f - (m if mass is None else mass) * acceleration
        for symbol in law.terms:
            p, force = values.get(law.key(symbol, i), math.nan), term(symbol).force
            if symbol != FRICTION and math.isfinite(p) and force is not None:
                f = f - p * force(v, w, found.k, omega)
        loops.append({"phase_rad": cycle["phase"], "x_m": x, "v_m_per_s": v, "f_N": f})
    return loops


@with_options
def identify_forced(
    records: RecordLike | Sequence[RecordLike],
    stiffness: Stated | None = None,
    *,
    mapping: MappingLike = None,
    mass: Stated | None = None,
    frequency: float | str | None = None,
    groups: Mapping[str, Sequence[str] | str] | None = None,
    contact_to: Literal["ground", "base"] = "ground",
    fixture_mass: float | str | None = None,
    skip_cycles: int = 0,
    laws: bool = False,
    terms: Sequence[str] | str | None = None,
    given: Mapping[str, float] | None = None,
    **unknown: Never,
) -> Result[ForcedBasis]:
    """Identify the coefficients of a damping law and K_z from forced records, one for each level of excitation.

    Each steady response gives a row a F_k + b c = W of the energy balance (Eq. 6 of the paper), weighted by inverse
    variance. The answer is the maximum-likelihood fit of one oscillator to all records, checked by the balance; where
    no oscillator has the waveforms of the records, the balance is the answer.

    records : what `read_records` returns or takes; at least as many as coefficients, at levels far apart.
    stiffness : k of the spring, N/m, or a text with its unit, "5.2 N/mm"; F_k and c are in proportion to it. State its
    standard uncertainty, too, as (2310.0, 10.0) or "2310±10": the intervals then include it, as they include those of
    gains and delays that a mapping states. Otherwise they are conditional on k.
    mapping : names, units and corrections of channels that the files do not state.
    The options of the signature, which `help` describes.

    Several names or labels (terms, groups) may be one text with commas: terms="F_k,c".

    Raises ValueError (for a record, `RecordError`), which names the argument or the record, what is wrong and the
    remedy: for an argument of another type or outside its range, a record that cannot be used, and fewer records than
    unknowns.

    >>> import math
    >>> from dampbalance import BaseMotion, Oscillator, identify_forced, measured_orbit, steady_orbit
    >>> osc = Oscillator(m=2.42, c=90.0, k=2310.0, K_z=208000.0, F_k=1.28)
    >>> motions = [BaseMotion(Y=Y, omega=2 * math.pi * 3.5) for Y in (0.004, 0.008, 0.012)]
    >>> records = [
    ...     measured_orbit(steady_orbit(osc, motion), rate_hz=1000.0, cycles=20.0, noise=0.01, seed=i)
    ...     for i, motion in enumerate(motions)
    ... ]
    >>> found = identify_forced(records, stiffness=2310.0)
    >>> {symbol: round(value, 1) for symbol, value in found.values.items() if symbol != "K_z"}
    {'F_k': 1.3, 'c': 90.0}
    >>> low, high = found.intervals["c"]
    >>> bool(low < osc.c < high)
    True
    >>> found.verdicts["F_k"].verdict
    'usable'
    """
    read, of = read_request("forced", records, mapping, options_of(locals()))
    return _of_records(read, law_of(of["terms"], of["given"], of["groups"]), of)


def _of_records(
    records: tuple[Record, ...], law: Law, options: Mapping[str, Any]
) -> Result[ForcedBasis]:
    """Return the answers to records that are read.   options : by the keys of a configuration."""
    k, masses = options["stiffness_N_per_m"], masses_of(records, options)
    if k is None:
        require_driven_by(True, records, "no stiffness of a force")
        # a coefficient that is given is that of the true k: the first k comes without it
        passes = [
            partial(_of_records, records, of) for of in ([Law()] if law.given else []) + [law]
        ]
        options, k = with_stiffness_by_mass(passes[0], options, *passes[1:])
        masses = Masses(None, None)
    mass = masses.moving
    of_drive = {name: options[name] for name in ("frequency_hz", "skip_cycles")}
    readings = [load(record, k, base_mass=masses.on_base, **of_drive) for record in records]
    require_possible(readings, mass, k, records[0].coordinate)
    records, readings, clipped = unclipped(records, readings, law)
    outcome = identify_readings(
        readings,
        k,
        mass=mass,
        mass_error=options["mass_standard_error_kg"] or 0.0,
        stiffness_error=options["stiffness_standard_error_N_per_m"] or 0.0,
        law=law,
    )
    held = mass if outcome.basis.common.mass_taken else None
    laws = compare_laws(readings, k, mass=held, law=law) if options["laws"] else None
    odd = (*clipped, *outcome.odd)
    if wrong := [*misread(outcome.basis.common, records, readings, law, k)]:
        # what the fit and the rows say, and what puts all numbers off, follows from that
        odd = (*wrong, *(one for one in odd if one.of and one.largest < math.inf))
        estimates = {name: replace(of, notes=()) for name, of in outcome.estimates.items()}
        reference = outcome.reference and replace(outcome.reference, notes=())
        outcome = replace(outcome, estimates=estimates, reference=reference)
    else:
        odd += (*of_a_mount(outcome.basis.common, records, k, masses, law, of_drive),)
    outcome = replace(outcome, laws=laws, records=records, options=options, odd=odd)
    return with_stated_uncertainties(outcome)


@one_thread
def identify_readings(
    readings: Sequence[Reading],
    k: float,
    *,
    law: Law | None = None,
    mass: float | None = None,
    mass_error: float = 0.0,
    stiffness_error: float = 0.0,
) -> Result[ForcedBasis]:
    """Return the coefficients of a damping law and K_z from the features of n measured responses, with intervals.

    Use `identify_forced` for records, and this function where the readings are available, as in studies.

    readings : from `read_features`, of different levels, at least as many as unknowns.
    k : stiffness with which they were read, N/m.
    law : default, F_k and c.
    mass : kg, as for `identify`.
    mass_error, stiffness_error : standard uncertainties of the mass, kg, and of k, N/m, for the test of the mass.

    Raises ValueError for fewer readings than unknowns unless the fit distinguishes these, terms that act alike in all
    readings, two readings of the same signals, a stiffness or a mass that is not positive, and another stiffness than
    that of the readings. A balance whose rows cannot be solved stays in the result, with NaN and the reason.
    """
    law = law or Law()
    require_different_levels(readings, k, law)
    if mass is not None:
        number("mass", mass, NUMBERS["m"])
    lines = [reading.lines for reading in readings]
    channels = {q for reading in readings for q in reading.steady.channels}
    # where a force drives, the base is at rest; channels of both kinds test each other
    on_base = any(reading.steady.base_mass is not None for reading in readings)
    framed = not ("force" in channels or on_base) and not (
        channels & {*ABSOLUTE} and channels & {*RELATIVE}
    )
    common = common_fit(
        *(lines, k, mass, law),
        mass_error=mass_error,
        stiffness_error=stiffness_error,
        frames=framed,
    )
    few, reference = len(readings) < len(law.unknowns), common.answer
    if few and not (common.waveforms_hold and common.fit is not None and common.fit.freedom > 0):
        law.require([reading.steady.frequency_hz for reading in readings])
    if few and reference is not None:
        reference = replace(
            reference, notes=(*reference.notes, Finding("fewer levels", effect=UNBOUNDED))
        )
    readings = with_common_fit(readings, common, law)
    own = features_of(readings, [reading.mean for reading in readings])
    K_z = reference.K_z if reference is not None and common.waveforms_hold else UNKNOWN
    direct = _balance(readings, law, k, K_z, frictionless=common.frictionless)
    notes = (*direct.notes, *notes_on(direct, readings, common))
    direct = replace(direct, notes=notes)
    hz = ", ".join(f"{f:g}" for f in sorted({round(r.steady.frequency_hz, 4) for r in readings}))
    fit, rig = common.fit, list[Finding]()
    if fit is not None:
        rig = implied(common.closest, mass if common.mass_fits else None)
    of_records = on_records(readings, common)
    of_all = [*agreement(readings, common, direct)]
    if common.delay is not None and not any(one.code == "weighs" for one in of_all):
        rig.append(Finding("timing", {"late": common.delay}))
    found = Result(
        basis=ForcedBasis(law, tuple(readings), common, own[:, 0]),
        k=k,
        sources=tuple(reading.steady.source for reading in readings),
        estimates={DIRECT: direct},
        reference=reference,
        odd=(*of_records, *of_all),
        head=f"{len(readings)} record{'s' * (len(readings) > 1)} at {hz} Hz; the answer first, with 95 % intervals",
        rig=rig,
        weighed=() if common.selection is None else weighed_of(common.selection),
        settings={"law": {"terms": law.terms, "given": law.given, "groups": law.groups}},
    )
    check, doubts = _checked(found)
    return replace(found, check=[check], odd=(*found.odd, *doubts))


def _checked(found: Result[ForcedBasis]) -> tuple[Finding, list[Finding]]:
    """Return the comparison of balance and fit (`compared`), after the records of the balance have been corrected for
    gain and delay of the fit."""
    direct, common, readings = found.estimates[DIRECT], found.basis.common, found.basis.readings
    lacks = not_in_rows(readings, common)
    if not lacks:
        return compared(doubted({DIRECT: direct}, ())[DIRECT], found.reference)
    clear = () if common.selection is None else common.selection.names
    corrected = [name for name in ("gain", "delay") if name in lacks and name in clear]
    if corrected and common.fit is not None and direct.balance is not None:
        gain, late = common.fit.value("gain"), common.fit.value("delay")
        means = [
            one.mean.delayed(-late * one.steady.omega, one.steady.added).changed(
                *(1.0 / (1.0 + gain), 1.0, 0.0, 1.0), one.steady.added
            )
            for one in readings
        ]
        # the fit has both already: none of its unknowns moves
        features = features_of(readings, means, np.zeros((common.fit.point.size, 1)))
        rows = rows_of(features[:, 0], found.basis.law, found.k, frictionless=common.frictionless)
        values = solved_again(rows, direct.balance.errors)
        moved = {s: p.at(values.get(s, p.value)) for s, p in direct.parameters.items()}
        direct = replace(direct, parameters=moved)
    lacks = [name for name in lacks if name not in corrected]
    return compared(direct, found.reference, lacks, corrected=corrected)


def _balance(
    readings: Sequence[Reading],
    law: Law,
    k: float,
    K_z: ParameterEstimate = UNKNOWN,
    *,
    frictionless: bool = False,
) -> Answer:
    """Return the coefficients by direct integration, with standard errors and intervals.   K_z : of the fit."""
    rows, solution = solved_forced(readings, law, k, frictionless=frictionless)
    merit = {"residual": math.nan, "misfit": math.nan}
    sources, notes = tuple(reading.steady.source for reading in readings), list[Finding]()
    if not solution.estimates:
        symbols = tuple(key for key in rows.terms if key not in rows.given)
        count, of_all = int(rows.usable.sum()), rows.usable.size
        of = {"symbols": symbols, "needed": len(symbols), "usable": count, "all": of_all}
        why = Finding("few rows" if count < len(symbols) else "rows alike", of)
        notes = [Finding("level for each") if len(readings) < len(law.unknowns) else why]
        K_z = UNKNOWN
    elif solution.freedom:
        off = rows.misfit({**rows.given, **solution.values})[rows.usable]
        merit["residual"] = float(np.linalg.norm(off) / np.linalg.norm(rows.W[rows.usable]))
        exact = (solution.errors == 0.0).any()  # such rows have no misfit to compare
        merit["misfit"] = math.nan if exact else solution.misfit
    nothing: dict[str, ParameterEstimate] = dict.fromkeys(law.unknowns, UNKNOWN)
    parameters = {**nothing, "K_z": K_z}
    return as_answer(
        *(DIRECT, solution, rows, sources, parameters), notes=tuple(notes), merit=merit
    )


@lru_cache(maxsize=1)  # asked for with each fault
def _by_mass(fit: WaveformFit) -> Array:
    """Return the changes of the unknowns with the relative change of a mass that is given, (p, 1)."""
    free, at = fit.parameters.freed("m").free, fit.parameters.places["m"]
    whole, by = fit.problem.evaluate(fit.point, free, Trail()), np.zeros(fit.point.size)
    if whole is not None:  # else the motion rattles
        by = -fit.m * fit.response @ whole[:, at]
    by[at] = fit.m
    return by[:, None]


def _with_fault(reading: Reading, fault: Fault) -> Means:
    """Return the means of a record with a fault.

    A force f moves the mass as the base motion f/k does, so that an error of k is one of that motion. An error of the
    mass m on a moving base, where f is −mÿ, is likewise.
    """
    steady = reading.steady
    on_base = steady.base_mass is not None
    lever = fault.mass * on_base - fault.stiffness * (on_base or "force" in steady.channels)
    turn = fault.late * steady.omega + fault.angle
    gains = 1.0 + fault.drive, 1.0 + fault.response
    return reading.mean.changed(*gains, turn, 1.0 + lever, steady.added)


def _moved(fit: WaveformFit, readings: Sequence[Reading], means: Sequence[Means]) -> Array:
    """Return the changes of the unknowns of a fit with other means of the records, to first order, (p, 1)."""
    triples = zip(readings, fit.waveforms, means, strict=True)
    return np.asarray(
        np.sum([replace(one, waveform=of).moved(mean) for one, of, mean in triples], axis=0)
    )


def _scaled(values: Mapping[str, float], k: float) -> dict[str, float]:
    """Return numbers of the oscillator of the same motion with k times the stiffness; eta is a part of it."""
    return {s: p if getattr(s, "symbol", s) == "eta" else k * p for s, p in values.items()}
