"""F_k, c and K_z from measured responses at several levels, by every approach, with standard errors and intervals.

The answer is the fit of one oscillator to all records (`oscillator.py`) where it holds; the balance checks it, and
serves where it does not. Each response gives one row a F_k + b c = W of the energy balance (6); rows of different
frequencies go together, since neither F_k nor c depends on the frequency. Rows are weighted by the inverse variance of
their misfit; the result of Eq. (9) as published, where all rows are weighted alike, is given next to it.

What a row needs of the onset of slip comes from the waveforms of one oscillator fitted to all records. Where the
records are not those of such an oscillator, the onset is unknown and K_z is not identified: direct integration then
takes a = 4X − λ with the λ of the oscillator that comes nearest, a small part of 4X where the contact is stiff. A level
that does not slip leaves the balance; where none slips, F_k is unknown, and W = b c gives c.

The effect of noise on the estimates is computed twice: by bootstrap (cycles of every record drawn with replacement, the
balance solved for each drawing) and by propagation (the jackknife: one cycle of one record left out after the other).
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from operator import itemgetter
from typing import Any

import numpy as np

from ..arguments import number, whole
from ..arrays import Array, Mask
from ..balance import APPROACHES, Approach, Rows
from ..features import COLUMNS, Features, Phase, stack
from ..law.law import Law
from ..law.terms import FRICTION, parted
from ..likelihood.mean_harmonics import Reading
from ..likelihood.unfolding import unfolded
from ..project.wording import Remark
from ..reading.one_thread import one_thread
from ..solver import Estimate, least_squares, solve
from .answer import (
    CONFIDENCE,
    REFERENCE,
    UNKNOWN,
    Answer,
    Balance,
    Interval,
    ParameterEstimate,
    covariance_of,
)
from .equivalents import Level
from .law_rows import LawRows
from .loading import Loaded
from .microstick import Microstick, Sample, Samples, microstick, read_samples
from .oscillator import JointFit, joined, joint_fit
from .outcome import Outcome, Picture
from .remarks import DIRECT, agreement, with_notes
from .screen import implied, with_error
from .sensitivities import Fault, sensitivities, shifts_of_fit

REPLICATES = 1000
SEED = 2010

_COPIED = 1e-9  # of the largest harmonic: what writing a record in another format may change


@dataclass(frozen=True, eq=False, kw_only=True)
class ForcedOutcome(Outcome):
    """The answers to records of steady responses, and all that they come from.

    law : whose coefficients are identified.
    phase : that the harmonic approaches take.
    readings : what was read off each record.
    joint : the fit of one oscillator to all records.
    features : of the records, (n,), with the onset of slip of that oscillator.
    microstick : the line that all records share.
    loaded : the records with their leading samples, for pictures.
    """

    law: Law
    phase: Phase
    readings: tuple[Reading, ...]
    joint: JointFit
    features: Features
    microstick: Microstick
    loaded: tuple[Loaded, ...] = ()

    def findings(self) -> dict[str, Any]:
        """Comparison of laws, microstick line, features of each record."""
        line = self.microstick
        return {
            **({} if self.laws is None else {"laws": self.laws.document()}),
            "microstick": {
                "length_m": line.length,
                "standard_error_m": line.standard_error,
                "resolved": line.resolved,
                "upper_bound_m": line.bound,
            },
            "records": [self._record(i) for i in range(len(self.readings))],
        }

    @property
    def levels(self) -> list[Level]:
        """A cycle of each record that has an input work."""
        of, a = self.features, self.features.a
        values = next(iter(self.answers.values())).values
        return [
            Level(
                reading.steady.source,
                float(of.X[i]),
                reading.steady.omega,
                float(of.W[i]),
                values.get(self.law.key(FRICTION, i), self.law.given.get(FRICTION, math.nan))
                * float(a[i]),
            )
            for i, reading in enumerate(self.readings)
        ]

    def shifts(
        self, faults: Mapping[str, Fault], names: Collection[str]
    ) -> dict[str, dict[str, dict[str, float]]]:
        """What faults of all records do to answers."""
        changes = {}
        for name, answer in self.estimates.items():
            way = APPROACHES.get(name) if name in names else None
            if way is not None:
                rows_of = LawRows(way, self.law, self.k, self.phase, self.joint.linear)
                changes[name] = sensitivities(self.readings, rows_of, answer, faults)
        fit = self.joint.fit if REFERENCE in names else None
        if fit is not None and self.joint.waveforms_hold:
            changes[REFERENCE] = shifts_of_fit(self.readings, fit, faults)
        return changes

    def _record(self, i: int) -> dict[str, Any]:
        reading, steady = self.readings[i], self.readings[i].steady
        errors = reading.standard_errors
        return {
            "record": steady.source,
            "frequency_Hz": steady.frequency_hz,
            "frequency_standard_error_Hz": steady.omega_standard_error / (2.0 * math.pi),
            "cycles": steady.cycles,
            "highest_harmonic": steady.bandwidth,
            "noise_rms": steady.noise_rms,
            "slips": reading.slips,
            "features": {c: getattr(self.features, name)[i] for name, c in COLUMNS.items()},
            "standard_errors": {column: errors[name] for name, column in COLUMNS.items()},
            "warnings": reading.warnings,
        }

    def features_table(self) -> list[dict[str, Any]]:
        """A row for each record: its features, and the standard error of each."""
        columns = self.features.to_columns()
        return [
            {"record": reading.steady.source}
            | {column: values[i] for column, values in columns.items()}
            | {
                column.replace(name, f"{name}_standard_error", 1): reading.standard_errors[name]
                for name, column in COLUMNS.items()
            }
            for i, reading in enumerate(self.readings)
        ]

    def _damping(self) -> list[dict[str, float]]:
        """Of each record the coefficients of all terms but friction that are known, SI."""
        values = {**next(iter(self.answers.values())).values, **self.law.given}
        keys = [
            {s: self.law.key(s, i) for s in self.law.terms if s != FRICTION}
            for i in range(len(self.readings))
        ]
        return [
            {s: values[key] for s, key in of.items() if math.isfinite(values.get(key, math.nan))}
            for of in keys
        ]

    @property
    def pictures(self) -> dict[str, Picture]:
        """cycles : each record folded onto one cycle.   friction : friction force against displacement.   loops :
        acceleration against displacement.   balance : its rows and what they leave."""
        count, two = len(self.readings), set(self.law.keys) == {"F_k", "c"}
        fit = None if self.joint.linear else self.joint.fit
        line = "on a line of slope F_k" if two else "on the line where the law takes the input work"
        return {
            "cycles": Picture(
                f"{count} records folded onto one cycle of the drive, with their averaged cycle, the fitted one and "
                "what it leaves of the samples",
                (self.loaded, self.readings, fit),
            ),
            "friction": Picture(
                f"friction force against displacement of {count} records, with the loop of the fitted oscillator",
                (self.loaded, self.readings, self.k, self._damping(), fit),
            ),
            "loops": Picture(
                f"acceleration against displacement of {count} records, with the fitted microstick lines",
                (self.loaded, self.readings, self.microstick),
            ),
            "balance": Picture(
                f"rows of the energy balance {line}, and the residual of each row by approach",
                (self.answers, two),
            ),
        }


@one_thread
def identify_readings(
    readings: Sequence[Reading],
    k: float,
    *,
    law: Law | None = None,
    approaches: Mapping[str, Approach] = APPROACHES,
    phase: Phase = "reversal",
    mass: float | None = None,
    uncertainty: float = 0.0,
    replicates: int = REPLICATES,
    seed: int = SEED,
) -> ForcedOutcome:
    """The coefficients of a damping law and K_z from the features of n measured responses, with intervals.

    Use `identify` for records; this function is for readings that are at hand, as in studies.

    readings : of `read_features`, one per level; levels that differ, at least as many as there are unknowns for a
    balance. The fit may do with fewer.
    k : stiffness of the readings, N/m.
    law : default, F_k and c.
    approaches : by name.
    phase : that the harmonic approaches take.
    mass : kg, if it is known.
    uncertainty : standard uncertainty of k, as a part of it, for the test of the mass.
    replicates, seed : of the bootstrap; 1000 replicates know a standard error to 2 %.

    Raises ValueError for fewer readings than unknowns where no fit distinguishes these, terms that act alike in all of
    them, two of the same signals, a stiffness or a mass that is not positive, a stiffness that is not that of the
    readings, and too few or too many replicates. An approach whose rows cannot be solved stays in the result with NaN
    and the reason.
    """
    law = law or Law()
    _require(readings, k, law, approaches, replicates)
    if mass is not None:
        number("mass", mass)
    readings, near = unfolded(readings, k, law)
    lines = [reading.lines for reading in readings]
    joint = joint_fit(lines, k, mass, law, near, uncertainty=uncertainty)
    few = len(readings) < len(law.unknowns)
    if few and not (joint.waveforms_hold and joint.fit is not None and joint.fit.freedom > 0):
        law.require([reading.steady.frequency_hz for reading in readings])
    readings = joined(readings, joint, law)
    samples = read_samples(readings, replicates, np.random.default_rng(seed))
    line = microstick(samples)
    estimates = {
        name: _answer(
            name, LawRows(way, law, k, phase, joint.linear), joint, readings, samples, line
        )
        for name, way in approaches.items()
    }
    estimates = with_notes(estimates, readings, joint)
    reference = joint.answer
    if few and reference is not None:
        reference = replace(reference, notes=(*reference.notes, _UNCHECKED))
    of_records = [words.about(r.steady.source) for r in readings for words in r.warnings]
    of_all = agreement(readings, line, joint, estimates)
    return ForcedOutcome(
        k=k,
        sources=tuple(reading.steady.source for reading in readings),
        estimates=estimates,
        reference=reference,
        warnings=(*of_records, *of_all),
        head=_head(readings, replicates),
        rig=_rig(joint),
        settings={
            "law": {"terms": law.terms, "given": law.given, "groups": law.groups},
            "phase": phase,
            "confidence": CONFIDENCE,
            "bootstrap": {"replicates": replicates, "seed": seed},
        },
        law=law,
        phase=phase,
        readings=tuple(readings),
        joint=joint,
        features=samples.point.features.with_phase(phase),
        microstick=line,
    )


def _head(readings: Sequence[Reading], replicates: int) -> str:
    """How many records, at which frequencies."""
    hz = ", ".join(f"{f:g}" for f in sorted({round(r.steady.frequency_hz, 4) for r in readings}))
    return (
        f"{len(readings)} record{'s' * (len(readings) > 1)} at {hz} Hz; the answer first, with 95 % intervals, those "
        f"of the balance from {replicates} bootstrap replicates"
    )


def _rig(joint: JointFit) -> list[str]:
    """Mass and natural frequency of the fit, and the delay between the channels."""
    fit, delayed = joint.fit, joint.delayed
    if fit is None or joint.linear:
        return []
    sentences = implied(fit)
    if fit.adequate and delayed is not None:
        late = with_error(1e6 * delayed.delay, 1e6 * delayed.error("delay"))
        sentences.append(f"Left free, a delay of the response is {late} µs.")
    return sentences


def _require(
    readings: Sequence[Reading],
    k: float,
    law: Law,
    approaches: Mapping[str, Approach],
    replicates: int,
) -> None:
    number("stiffness", k)
    whole("replicates", replicates)
    law.require([r.steady.frequency_hz for r in readings], by_balance=False)
    for reading in readings:
        if reading.steady.k != k:
            raise ValueError(
                f"{reading.steady.source} was read with k = {reading.steady.k:g} N/m, not with {k:g} N/m"
            )
    for reading, other in itertools.combinations(readings, 2):
        if _same(reading, other):
            raise ValueError(
                f"{reading.steady.source} and {other.steady.source} hold the same signals: each record is one level"
            )
    if not approaches:
        raise ValueError(f"no approach is asked for; known are {', '.join(APPROACHES)}")


def _same(one: Reading, other: Reading) -> bool:
    """Whether two records are copies of one, in whatever format: their cycles have the same harmonics."""
    rows, others = one.steady.X, other.steady.X
    bound = _COPIED * abs(rows[0, 1])
    if rows.shape != others.shape or not abs(rows[0, 1] - others[0, 1]) < bound:
        return False
    return bool(np.abs(rows - others).max() < bound)


_UNCHECKED = Remark(
    "there are fewer levels than coefficients: only the shape of the waveforms distinguishes them, and no balance "
    "checks it; add records at other amplitudes"
)
_TOO_FEW = "a balance needs a level for each coefficient: add records at other amplitudes"
_NO_FORM = "this approach has no form of a term of the law"
_NO_ONSET = "this approach needs the onset of slip, which these records do not determine"


def _answer(
    name: str,
    rows_of: LawRows,
    joint: JointFit,
    readings: Sequence[Reading],
    samples: Samples[Sample],
    line: Microstick,
) -> Answer:
    """The answer of one approach, with standard errors and intervals."""
    sources = tuple(reading.steady.source for reading in readings)
    rows = samples.map(lambda sample: rows_of(sample.features))
    point, usable = rows.point, rows.point.usable
    uncertain = replace(point, covariance=rows.drawn.scatter())
    nothing = dict.fromkeys(rows_of.law.unknowns, UNKNOWN)
    try:
        estimate = least_squares(uncertain)
    except ValueError as error:
        unresolved = not joint.waveforms_hold and not joint.linear and name != DIRECT
        unshaped = any(
            np.isnan(g).all() and parted(key)[0] not in rows_of.approach.terms
            for key, g in point.terms.items()
        )
        few = len(readings) < len(rows_of.law.unknowns)
        reason = _TOO_FEW if few else str(error)
        reason = _NO_FORM if unshaped else _NO_ONSET if unresolved else reason
        parameters = {**nothing, "K_z": UNKNOWN}
        return Answer(
            name,
            parameters,
            covariance_of(parameters, {}),
            (Remark(reason),),
            Balance(point, np.full(len(point.W), math.nan), sources),
            equal=nothing,
            merit={"residual": math.nan, "misfit": math.nan},
        )
    weights = uncertain.weighted(estimate.values).weights
    assert weights is not None
    weighted = np.isfinite(weights[usable]).all()  # exact rows have no errors
    shared = weights if weighted else np.ones(len(weights))
    estimates = Samples(
        estimate, _weighed(rows.drawn, shared), tuple(_weighed(r, shared) for r in rows.left)
    )
    K_z, roots = _stiffness(samples, estimates, rows_of.law, line)
    errors = dict(estimates.drawn.values)
    if roots is not None:
        errors["K_z"] = -roots  # K_z falls as its inverse root grows
    correlations = {
        (one, other): float(np.corrcoef(errors[one], errors[other])[0, 1])
        for one, other in itertools.combinations(errors, 2)
    }
    parameters = nothing | _parameters(estimates) | {"K_z": K_z}
    freedom = int(estimate.n) - len(estimate.values)
    off = point.misfit({**point.given, **estimate.values})[usable]
    return Answer(
        name,
        parameters,
        covariance_of(parameters, correlations),
        balance=Balance(point, 1.0 / np.sqrt(weights), sources),
        correlations=correlations,
        equal=nothing | _parameters(rows.map(solve)),
        shape_bias=_shape_bias(rows_of, joint, readings, shared, usable),
        merit={
            "residual": float(np.linalg.norm(off) / np.linalg.norm(point.W[usable]))
            if freedom
            else math.nan,
            "misfit": float(weights[usable] @ off**2) / freedom
            if freedom and weighted
            else math.nan,
        },
    )


def _weighed(rows: Rows, weights: Array) -> Estimate:
    """The estimates from rows of replicates, (n, r), weighted like those of the records, (n,)."""
    return solve(replace(rows, weights=np.broadcast_to(weights[:, None], rows.W.shape)))


def _shape_bias(
    rows_of: LawRows, joint: JointFit, readings: Sequence[Reading], weights: Array, used: Mask
) -> dict[str, float]:
    """Relative error of each coefficient that the approach finds in the exact responses of the joint fit."""
    fit = joint.fit
    if fit is None or not joint.waveforms_hold:
        return {}
    exact = stack([reading.exact_features for reading in readings])
    estimate = solve(replace(rows_of(exact), weights=weights)[used])
    return {
        key: float(value) / fit.value(key) - 1.0
        for key, value in estimate.values.items()
        if fit.value(key) > 0.0
    }


def _stiffness(
    samples: Samples[Sample], estimates: Samples[Estimate], law: Law, line: Microstick
) -> tuple[ParameterEstimate, Array | None]:
    """K_z = 2F_k/L (10), from the root of its inverse, whose errors are nearly normal, and that root of each drawing.

    Where the microstick line is not resolved, K_z is a lower limit and there are no roots.
    """

    def friction(of: Estimate) -> Array:
        forces = [of.values.get(key, law.given.get(key, math.nan)) for key in law.keys_of(FRICTION)]
        return np.mean(np.broadcast_arrays(*forces), axis=0)

    def root(sample: Sample, of: Estimate) -> Array:
        with np.errstate(divide="ignore", invalid="ignore"):
            return sample.rho * np.sqrt(np.maximum(sample.F_k / friction(of), 0.0))

    if not float(friction(estimates.point)) > 0.0 or not math.isfinite(line.length):
        return UNKNOWN, None
    roots = Samples(
        root(samples.point, estimates.point)[0],
        root(samples.drawn, estimates.drawn),
        tuple(map(root, samples.left, estimates.left)),
    )
    inverse_root = _parameter(roots)
    low, high = inverse_root.interval
    if not line.resolved:
        unbounded = Interval(high**-2, math.inf)
        return ParameterEstimate(math.inf, math.nan, math.nan, unbounded), None
    slope = 2.0 * inverse_root.value**-3
    K_z = ParameterEstimate(
        inverse_root.value**-2,
        slope * inverse_root.standard_error,
        slope * inverse_root.propagated_error,
        Interval(high**-2, low**-2 if low > 0.0 else math.inf),
    )
    return K_z, roots.drawn


def _parameters(estimates: Samples[Estimate]) -> dict[str, ParameterEstimate]:
    return {s: _parameter(estimates.map(itemgetter(s))) for s in estimates.point.values}


def _parameter(values: Samples[Array]) -> ParameterEstimate:
    """Standard errors and interval of one number.

    The variances that the records contribute, v_i of g_i groups, give the degrees of freedom of their sum,
    (Σ v_i)²/Σ v_i²/(g_i − 1) (Welch–Satterthwaite), and the degrees of freedom the quantile of Student's t.
    """
    from scipy import special  # slow to import, as scipy.stats with the same functions is

    value, error = float(values.point), float(values.drawn.std(ddof=1))
    parts = np.array([(len(p) - 1) / len(p) * np.sum((p - p.mean()) ** 2) for p in values.left])
    groups = np.array([len(p) for p in values.left])
    total = float(parts.sum())
    freedom = total**2 / float(np.sum(parts**2 / (groups - 1))) if total > 0.0 else math.inf
    reach = float(special.stdtrit(freedom, 0.5 + 0.5 * CONFIDENCE)) * error
    return ParameterEstimate(value, error, math.sqrt(total), Interval(value - reach, value + reach))
