"""The friction force of the frame at each load, the loops of its records, and predictions of held-out cycles.

The interval of the identification holds for the mean over the cycles of a record and for one definition of the travel.
`robust_interval_N` widens it by what else moves F_k:

    drift       F_k,i = (W_i − Σ p_j g_j,i)/a_i of the cycles i as recorded follows a straight line whose slope differs
                from zero (Student's t, Bonferroni's correction for the number of records): both ends count
    convention  a = 4X with X from the levels of the rests, or from the extremes of the Fourier series, which ring there
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from scipy import special

from ...arrays import Array
from ...balance import APPROACHES, TERMS, checks
from ...features import Features
from ...identification.forced import identify_readings
from ...identification.loading import Loaded, load
from ...identification.remarks import DIRECT
from ...law.law import Law, law_of
from ...law.terms import FRICTION, term
from ...likelihood.mean_harmonics import Reading, read_features
from ...model import named_with_unit
from ...reading.turning import turning_points
from ...records.measured import read_records
from ...records.measurement import Channel, Measurement
from .friction import (
    AT_REST,
    SPEED_LAWS,
    Loop,
    Mass,
    SpeedLaw,
    friction_loop,
    linear,
    predicted,
    shape,
)


class Drift(NamedTuple):
    """The straight line through forces at equal steps, N.

    slope, error : per step, and its standard error.
    p : probability of a slope as large as this if there were none, by Student's t.
    significant : whether p is small enough where several such tests are made together.
    reach : half the width of the interval about the middle of the line.
    over_record : by how much the line rises from the first force to the last.
    """

    slope: float
    error: float
    p: float
    significant: bool
    reach: float
    over_record: float


def friction_of_rows(reading: Reading, others: Mapping[str, float]) -> Array:
    """The friction force in each row (a cycle, or several) of a record by direct integration, N, (rows,).

    others : coefficients of the terms other than friction, by symbol; the reading has their integrals.

    The forces are pseudo-values of the jackknife, n F − (n − 1) F₋ᵢ: the levels of the rests are read off a mean of
    n − 1 cycles, as they are off all of them, and not off a single noisy cycle.
    """

    def friction(features: Features) -> Array:
        rows = APPROACHES[DIRECT](features, reading.steady.k, (FRICTION, *others))
        work = np.sum([p * rows.terms[symbol] for symbol, p in others.items()], axis=0)
        return np.asarray((rows.W - work) / rows.terms[FRICTION])

    left = friction(reading.features_of(reading.left_out()))
    return left.size * friction(reading.features) - (left.size - 1) * left


def drift(forces: Array, confidence: float, tests: int) -> Drift:
    """The straight line through forces, (n,) with n ≥ 3, by least squares.

    confidence : of the interval, and of so many `tests` together, each at (1 − confidence)/tests (Bonferroni).
    """
    step = np.arange(forces.size) - 0.5 * (forces.size - 1)
    slope = float(step @ forces / (step @ step))
    off, freedom = forces - forces.mean() - slope * step, forces.size - 2
    # what rounding leaves of a force that does not change may well lie on a line
    scatter = max(math.sqrt(float(off @ off) / freedom), _ROUNDING * float(np.abs(forces).max()))
    error = scatter / math.sqrt(float(step @ step))
    p = 2.0 * float(special.stdtr(freedom, -abs(slope) / error)) if error > 0.0 else 1.0
    quantile = float(special.stdtrit(freedom, 0.5 + 0.5 * confidence))
    reach = quantile * scatter / math.sqrt(forces.size)
    rise = slope * (forces.size - 1)
    return Drift(slope, error, p, p < (1.0 - confidence) / tests, reach, rise)


_GRAVITY = 9.80665  # the standard one, m/s²
_CONFIDENCE = 0.95
_ROUNDING = 1e-12  # of a force


@dataclass(frozen=True, eq=False)
class Prediction:
    """Held-out cycles: times, s, and displacements, m, each of shape (n,).

    predicted : by each law of `SPEED_LAWS`, by its name.
    repeated : the mean of the cycles that the law was identified from, continued.
    """

    t: Array
    measured: Array
    predicted: Mapping[str, Array]
    repeated: Array


@dataclass(frozen=True, eq=False)
class Findings:
    """The results for all records of the frame.

    document : every number, for JSON.   loops, predictions : one for each record.
    """

    document: dict[str, Any]
    loops: tuple[Loop, ...]
    predictions: tuple[Prediction, ...]


def findings(
    files: Sequence[str | Path],
    measured: Mapping[str, Any],
    frame: Mapping[str, Any],
    identified: Mapping[str, Any],
) -> Findings:
    """All results for the frame: forces, line, loops and predictions.

    files : of the records.   measured : their set in the configuration.   frame : the section of that name.
    identified : the document of their identification.

    Raises ValueError where the section does not fit the records.
    """
    require(measured, frame, len(files))
    k, m, loads = measured["stiffness_N_per_m"], measured["mass_kg"], frame["loads_kg"]
    law = law_of(measured.get("terms"), measured.get("given"), measured.get("groups"))
    records = [load(one, k) for one in read_records(files, mapping=measured.get("mapping"))]
    further = tuple(symbol for symbol in law.terms if symbol not in TERMS)
    readings = [Reading(one.reading.steady, joint=True, terms=further) for one in records]
    direct = identified["approaches"][DIRECT]
    forces = [
        _force(direct, law, i, reading, records[i], len(records))
        for i, reading in enumerate(readings)
    ]
    errors = [force["standard_error_N"] for force in forces]
    (line, off), (by_series, _) = (
        load_line(loads, [force[name] for force in forces], errors)
        for name in ("F_k_N", "F_k_by_series_N")
    )
    given = [
        np.multiply(p, direct["rows"][term(of).integral_column]) for of, p in law.given.items()
    ]
    lost = (np.sum(given, axis=0) / np.array(direct["rows"]["W_J"])).tolist()
    rows, loops, predictions = [], [], []
    for i, (first, F_k) in enumerate(_first_cycles(records, k, law, frame["cycles_identified"])):
        loop, fitted = friction_loop(readings[i], m, law.given), speed_laws_of(first, m, F_k, law)
        prediction = _prediction(records[i].record.whole(), first, m, law, fitted)
        held_out = prediction.measured
        errors_of = {
            name: {
                "rms": float(np.sqrt(np.mean((x - held_out) ** 2))) / loop.X,
                "range": float(np.ptp(x) / np.ptp(held_out)) - 1.0,
            }
            for name, x in {**prediction.predicted, "repeated": prediction.repeated}.items()
        }
        row = {
            "record": records[i].record.label,
            "load_kg": loads[i],
            **forces[i],
            "off_line": off[i],
            "lost_to_damper": lost[i],
            "X_m": loop.X,
            "loop": shape(loop, forces[i]["F_k_N"]),
            "foretold": {
                **errors_of["constant"],
                "rms_of_mean_cycle": errors_of["repeated"]["rms"],
                "F_k_N": F_k,
            },
            "speed_laws": {
                name: {**fit.coefficients, **errors_of[name]} for name, fit in fitted.items()
            },
        }
        rows.append(row)
        loops.append(loop)
        predictions.append(prediction)
    files_of = [
        (one.get("record") or one["file"], one["sha256"])
        for record in identified["records"]
        for one in (record, *record.get("others", ()))
    ]
    document = {
        "files": dict(sorted((Path(name).name, digest) for name, digest in files_of)),
        "line": line,
        "line_by_series": by_series,
        "mass_kg": m,
        "loads": rows,
        "speed_laws": {
            name: math.sqrt(np.mean([row["speed_laws"][name]["rms"] ** 2 for row in rows]))
            for name in SPEED_LAWS
        },
        "cycles_identified": frame["cycles_identified"],
    }
    return Findings(document, tuple(loops), tuple(predictions))


def require(measured: Mapping[str, Any], frame: Mapping[str, Any], records: int) -> None:
    """ValueError where the section `frame` does not fit its set of so many records."""
    if measured.get("mass_kg") is None:
        raise ValueError("frame: needs the mass of the records; give mass_kg for their set")
    if DIRECT not in (measured.get("approaches") or checks()):
        raise ValueError(f"frame: needs the approach {DIRECT}; add it to those of its set")
    if (loads := len(frame["loads_kg"])) != records:
        raise ValueError(
            f"frame: loads_kg names {loads} loads for {records} records; give one for each"
        )


def load_line(
    loads: Sequence[float], forces: Sequence[float], errors: Sequence[float]
) -> tuple[dict[str, Any], list[float]]:
    """F_k = F_0 + s·load by unweighted least squares, and the relative distance of each force from the line.

    loads : kg, three or more.   forces : F_k at each, N.   errors : their standard errors from the cycles, N.

    `slope_N_per_kg` s and `intercept_N` F_0, with intervals of 95 % by Student's t from the scatter about the line;
    `coefficient` s/g of friction, if the load alone presses; `scatter`, the scatter about the line relative to
    that which the standard errors predict: 1 where the cycles explain all of it, None where these are all 0.
    """
    load, force = np.asarray(loads), np.asarray(forces)
    columns = np.column_stack([np.ones(load.size), load])
    inverse = np.linalg.inv(columns.T @ columns)
    intercept, slope = (inverse @ columns.T @ force).tolist()
    off = force - intercept - slope * load
    freedom = load.size - 2
    variance = float(off @ off) / freedom
    quantile = float(special.stdtrit(freedom, 0.5 + 0.5 * _CONFIDENCE))
    reach = (quantile * np.sqrt(variance * np.diag(inverse))).tolist()
    left = np.eye(load.size) - columns @ inverse @ columns.T  # residuals of unit errors
    expected = float(np.sum(left**2 @ np.asarray(errors) ** 2)) / freedom
    line = {
        "slope_N_per_kg": slope,
        "slope_interval_N_per_kg": [slope - reach[1], slope + reach[1]],
        "coefficient": slope / _GRAVITY,
        "intercept_N": intercept,
        "intercept_interval_N": [intercept - reach[0], intercept + reach[0]],
        "scatter": math.sqrt(variance / expected) if expected > 0.0 else None,
    }
    return line, (off / force).tolist()


def _force(
    estimates: Mapping[str, Any], law: Law, i: int, reading: Reading, record: Loaded, records: int
) -> dict[str, Any]:
    """F_k of record i by direct integration with its verdict, and how it depends on the time in the record and
    on the convention of the travel.   records : how many there are."""
    key = law.key(FRICTION, i)
    force, error, (low, high) = (
        estimates[named_with_unit(f"{key}{end}", "N")]
        for end in ("", "_standard_error", "_interval")
    )
    keys = {symbol: law.key(symbol, i) for symbol in law.terms if symbol != FRICTION}
    others: dict[str, float] = {
        symbol: float(law.given[of] if of in law.given else estimates[term(of).column])
        for symbol, of in keys.items()
    }
    of_rows = friction_of_rows(reading, others)
    line = drift(of_rows, _CONFIDENCE, records)
    a = estimates["rows"][term(key).integral_column][i]
    at_rests, of_series = (
        float(turning_points(reading.series(reading.mean), rests=rests)[1][0])
        for rests in (True, False)
    )
    by_series = force * a / (a + 4.0 * (of_series - at_rests))
    reach = line.reach + (0.5 * abs(line.over_record) if line.significant else 0.0)
    per_cycle = of_rows.size / reading.steady.cycles
    return {
        "F_k_N": force,
        "standard_error_N": error,
        "interval_N": [low, high],
        **estimates["verdicts"][key],
        "drift": {
            "slope_N_per_cycle": line.slope * per_cycle,
            "standard_error_N_per_cycle": line.error * per_cycle,
            "p": line.p,
            "significant": line.significant,
            "over_record": line.over_record / force,
        },
        "F_k_by_series_N": by_series,
        "robust_interval_N": [
            min(low, by_series - force + low, force - reach),
            max(high, by_series - force + high, force + reach),
        ],
    }


def speed_laws_of(part: Reading, m: float, F_k: float, law: Law) -> dict[str, SpeedLaw]:
    """The laws of friction and speed that the cycles of a reading show, by name.

    m : kg.   F_k : friction force that does their work, N.   law : whose given terms are taken off the force.

    F_1 has its standard error by the jackknife, which leaves out one cycle after the other. The choice of the harmonics
    that stand out of the noise, which it holds, moves F_1 by about as much again.
    """
    loop = friction_loop(part, m, law.given)
    laws = {name: fitted(loop, F_k) for name, fitted in SPEED_LAWS.items()}
    left, key = part.left_out(), "F_1_N_s_per_m"
    slopes = [
        linear(friction_loop(part, m, law.given, left[[i]]), F_k).coefficients[key]
        for i in range(left.Y.size)
    ]
    error = math.sqrt((len(slopes) - 1) * float(np.var(slopes)))
    known = {**laws["linear"].coefficients, "F_1_standard_error_N_s_per_m": error}
    return laws | {"linear": replace(laws["linear"], coefficients=known)}


def _first_cycles(
    records: Sequence[Loaded], k: float, law: Law, cycles: int
) -> list[tuple[Reading, float]]:
    """Each record's first cycles as they are read, and the F_k that all of them identify."""
    parts = []
    for one in records:
        steady = one.reading.steady
        if not cycles < steady.cycles:
            raise ValueError(f"{one.record.name}: has {steady.cycles} cycles; identify from fewer")
        end = steady.start + 2.0 * math.pi / steady.omega * cycles
        measurement = one.record.whole()
        kept = []
        for c in map(measurement.__getitem__, measurement):
            inside = c.t < end + 2.0 * float(c.t[1] - c.t[0])  # for the last cycle to be whole
            kept.append(Channel(c.quantity, c.t[inside], c.values[inside]))
        parts.append(read_features(Measurement.of(one.record.name, kept), k))
    direct = {DIRECT: APPROACHES[DIRECT]}
    result = identify_readings(parts, k, law=law, approaches=direct)
    values = result.estimates[DIRECT].coefficients
    return [
        (replace(part, joint=True), values[law.key(FRICTION, i)].value)
        for i, part in enumerate(parts)
    ]


def _prediction(
    record: Measurement, first: Reading, m: float, law: Law, laws: Mapping[str, SpeedLaw]
) -> Prediction:
    """Predict the cycles that follow the identified ones, from the displacement and velocity at their beginning.

    law : whose given terms damp.   laws : of friction, by name.
    """
    steady = first.steady
    base, response = record.excitation, record["displacement"]
    period = 2.0 * math.pi / steady.omega
    begin = steady.start + steady.cycles * period
    kept = (response.t >= begin) & (response.t < begin + steady.cycles * period)
    t, x = response.t[kept], response.values[kept]
    loop = friction_loop(first, m, law.given)
    X_0, Y_0 = (float(steady.mean(rows)[0].real) for rows in (steady.X, steady.Y))
    zero = X_0 - Y_0 - loop.level / steady.k
    speed = float(np.gradient(response.values, response.t)[kept][0])
    speed = speed if abs(speed) > AT_REST * np.abs(loop.v).max() else 0.0
    y = np.interp(t, base.t, base.values)
    masses = {name: Mass(m, steady.k, of.force, law.given, zero) for name, of in laws.items()}
    displacements = {
        name: predicted(mass, t, y, float(x[0]), speed, steady.omega)
        for name, mass in masses.items()
    }
    phase = steady.omega * (t - steady.start) + float(np.angle(steady.mean(steady.Y)[1]))
    angles = np.linspace(0.0, 2.0 * math.pi, loop.x.size, endpoint=False)
    again = np.interp(phase, angles, loop.x, period=2.0 * math.pi) + X_0
    return Prediction(t, x, displacements, again)
