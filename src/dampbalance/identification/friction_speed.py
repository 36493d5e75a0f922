"""Friction at steady speeds: F_k and c from tables of mean forces.

At a steady speed no spring is deflected further and no mass is accelerated. K_z and the mass therefore cannot be
identified, and no stiffness is needed.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar, Never

import numpy as np

from ..findings.finding import Finding
from ..fit.friction_speed import DEPARTURES, SpeedFit, SteadySpeeds, fit_speeds
from ..fit.select import Selection
from ..law.terms import FRICTION
from ..project.options import Stated, options_of, with_options
from ..project.wording import listed
from ..records.channel import OF_FORCE
from ..records.mapping import MappingLike
from ..records.record import Record
from ..signals.whiteness import chance_of_averages
from .answer import UNKNOWN, Answer, Interval, ParameterEstimate, averaged, covariance_of
from .level import Column, Level
from .request import read_request
from .result import Picture, Result
from .sensitivities import Fault
from .stated import with_stated_uncertainties
from .weighing import weighed_of

if TYPE_CHECKING:
    from ..records.measured import RecordLike

_P_OTHER = 0.01  # that scatter alone follows the speed as much as a residual does
_FEWEST = 4  # rows
_PARTS = 6  # of the range of speeds, over whose averages a residual shows

(_ERROR,) = OF_FORCE


@dataclass(frozen=True, eq=False, repr=False)
class SpeedBasis:
    """The fits behind the answer to steady speeds.

    laws : the laws fitted to the rows of all tables, with their weights.   rows : number of rows of each table.
    """

    laws: Selection
    rows: Mapping[str, int]

    kind: ClassVar[str] = "friction-speed"
    mass_tests: ClassVar[bool] = False
    columns: ClassVar[Mapping[str, Column]] = {}

    def document(self, found: Result[Any]) -> dict[str, Any]:
        """Return the rows with the forces of the heaviest law."""
        fit, data = self.laws.fit, self.laws.fit.problem
        return {
            "speeds": {"velocity_m_per_s": data.v, "force_N": data.F}
            | {"force_standard_error_N": data.error, "force_of_the_law_N": data.F + fit.left},
            "records": [{"record": name, "rows": n} for name, n in self.rows.items()],
        }

    def levels(self, found: Result[Any]) -> list[Level]:
        """Return no levels, as the motion has no cycles."""
        return []

    def with_fault(self, found: Result[Any], name: str, fault: Fault) -> dict[str, float]:
        """Return the numbers with faults of gain: both are proportional to the force, and c inversely to the speed."""
        scale = {FRICTION: 1.0 + fault.drive, "c": (1.0 + fault.drive) / (1.0 + fault.response)}
        known = found.estimates[name].parameters.items()
        return {s: p.value * scale[s] for s, p in known if p is not UNKNOWN}

    def pictures(self, found: Result[Any]) -> dict[str, Picture]:
        """Return the force over the speed with the law, and the friction over the size of the speed."""
        from . import speed_pictures as drawn  # slow to import

        return {"speeds": Picture(drawn.speeds, (self.laws.fit,))}


@with_options
def identify_friction_speed(
    records: RecordLike | Sequence[RecordLike],
    stiffness: Stated | None = None,
    *,
    mapping: MappingLike = None,
    **unknown: Never,
) -> Result[SpeedBasis]:
    """Identify F_k and c from a table of mean forces, or torques, at steady speeds in both directions.

    Use it for a robot joint, a motor, a bearing or a tribometer whose friction was measured speed by speed. K_z cannot
    be identified from such a table. The law is

        T = F_k sgn v + c v + T_0

    T_0 is an offset of the sensor, or gravity; a friction that differs between the directions by 2T_0 has the same
    effect. Laws with a friction that falls with the speed, F_S e^{−|v/v_S|^δ} (Stribeck; δ = 1 or 2), or that is
    rounded at rest, F_k tanh(v/v_0), and with a quadratic damper are weighed by their evidence. F_k and c are averages
    over all of them, and the intervals include the differences that the data do not resolve. Errors follow from the
    scatter about the best law, or from a column of standard errors if every row has one.

    records : as `read_records` takes or returns them: one table or several of one contact, with a row for each speed
    and columns of velocity and of force or torque. Reduce samples in time to a mean at each steady speed beforehand.
    stiffness : leave it out, as there is no oscillator.
    mapping : the meaning of columns whose names do not give it, see `read_records`.
    The options of the signature, which `help` describes.

    Raises ValueError (for a record, `RecordError`) naming argument or record, what is wrong and the remedy: for a table
    without velocity or force, or with fewer rows than numbers to identify.

    >>> from dampbalance import identify_friction_speed
    >>> found = identify_friction_speed(
    ...     {"speed_rpm": [10, -10, 20, -20, 40, -40], "torque_N_m": [2.1, -1.9, 2.2, -2.0, 2.4, -2.2]}
    ... )
    >>> round(found.values["F_k"], 3), round(found.values["c"], 4)  # N m, N m s/rad
    (1.9, 0.0955)
    """
    read, of = read_request("friction-speed", records, mapping, options_of(locals()))
    data, rows, odd = _data(read)
    laws = fit_speeds(data)
    fit = laws.fit
    power = (fit.left + data.F - fit.value("T_0")) @ data.v
    # friction absorbs power; where the offset cannot be separated, the damping shows the sign
    if power < 0.0 and (data.both_ways or fit.value("c") < 0.0):
        odd.append(Finding("flipped", {"records": listed([*rows])}))
        laws = fit_speeds(data._replace(F=-data.F))
    answer, speeds, words = _answer(laws), data.sizes, read[0].coordinate
    found = Result(
        basis=SpeedBasis(laws, rows),
        k=math.nan,
        sources=tuple(rows),
        estimates={answer.name: answer},
        odd=tuple(odd),
        head=(
            f"{data.v.size} mean {words.noun('forces')} at steady speeds from {speeds[0]:.3g} to {speeds[-1]:.3g} "
            f"{words.unit('m/s')}, with 95 % intervals"
        ),
        rig=(),
        check=[*_rig(laws)],
        weighed=weighed_of(laws),
        records=tuple(read),
        options=of,
    )
    return with_stated_uncertainties(found)


def _data(records: Sequence[Record]) -> tuple[SteadySpeeds, dict[str, int], list[Finding]]:
    """Return the rows of all tables, the number of rows of each, and findings on them. Rows at rest are left out, as
    friction has no direction there.

    Raises ValueError for a table without velocity or force, with fewer rows than numbers, or at rest.
    """
    tables, rows, still, odd = [], {}, 0, list[Finding]()
    for record in records:
        if not {"velocity", "force"} <= {*record.quantities}:
            raise ValueError(
                f"{record.name} has {listed([*record.quantities])}: steady speeds need a velocity and a force, or an "
                "angular velocity and a torque; name them in its mapping"
            )
        channels = record.corrected()
        v, F = (channels[q].as_recorded for q in ("velocity", "force"))
        error = channels[_ERROR].as_recorded if _ERROR in channels else np.full(v.size, math.nan)
        given = np.isfinite(v) & np.isfinite(F)
        still += int(np.count_nonzero(given & (v == 0.0)))
        table = np.array([v, F, error])[:, given & (v != 0.0)]
        tables.append(table)
        rows[record.name] = table.shape[1]
        odd += [one.about(record.name) for one in record.warnings]
    v, F, error = np.hstack(tables)
    if v.size < _FEWEST:
        raise ValueError(
            f"{listed([*rows])} with {v.size} rows at speeds other than zero: F_k, c, an offset and their errors need "
            f"{_FEWEST} at least"
        )
    stated = bool((error > 0.0).all())
    if any(_ERROR in record for record in records) and not stated:
        odd.append(Finding("errors not used"))
    if still:
        odd.append(Finding("rows at rest", {"rows": still, "many": still > 1}))
    return SteadySpeeds(v, F, error if stated else np.ones(v.size), stated), rows, odd


def _answer(laws: Selection) -> Answer:
    """Return the answer averaged over the laws by their weights."""
    fit: SpeedFit = laws.fit
    notes, parameters = list[Finding](), {}
    for symbol in (FRICTION, "c"):
        ends = Interval(*fit.interval(symbol))
        parameters[symbol] = ParameterEstimate(fit.value(symbol), fit.error(symbol), ends)
    if not fit.problem.both_ways:
        sum_of = fit.value(FRICTION), fit.error(FRICTION)
        notes.append(Finding("one direction", {"sum": sum_of}))
        parameters[FRICTION] = UNKNOWN
    if not fit.has("c"):
        notes.append(Finding("one speed"))
        parameters["c"] = UNKNOWN
    for symbol, p in parameters.items():
        if p.interval.high < 0.0:
            notes.append(Finding("negative at steady speeds", {"value": ((symbol, p.value),)}))
            parameters[symbol] = UNKNOWN
    notes += _departure(fit)
    merit: dict[str, Any] = {"residual_rms_N": float(np.sqrt(np.mean(fit.left**2)))}
    merit |= {"misfit": fit.misfit} if fit.problem.stated else {}
    for name, unit in _UNITS.items():
        if fit.has(name):
            key = "offset" if name == "T_0" else name
            merit |= {f"{key}_{unit}": fit.value(name)}
            merit |= {f"{key}_standard_error_{unit}": fit.error(name)}
    known = [s for s, p in parameters.items() if p is not UNKNOWN]
    covariance = covariance_of(parameters, known, fit.covariance_of(*known))
    answer = Answer(_LAWS[laws.best.name], parameters, covariance, tuple(notes), merit=merit)
    return averaged(answer, laws)


_LAWS = {"": "Coulomb", "F_S": "Stribeck", "exponential": "Stribeck"}
_LAWS |= {"v_0": "rounded", "c_2": "quadratic"}
_UNITS = {"T_0": "N", "F_S": "N", "v_S": "m_per_s", "v_0": "m_per_s", "c_2": "N_s2_per_m2"}
"""Further numbers of a fit, with their units in the document."""


def _departure(fit: SpeedFit) -> Iterator[Finding]:
    """Yield a finding where the residual follows the speed: the force is another function of it."""
    data, unknowns = fit.problem, int(fit.parameters.free.sum()) - fit.has("T_0")
    order = np.argsort(np.abs(data.v), kind="stable")
    left = (np.sign(data.v) * fit.left / data.error)[order]
    width = max(2, left.size // _PARTS)
    p = chance_of_averages([left], [width], unknowns)
    if p < _P_OTHER:
        parts = left[: left.size // width * width].reshape(-1, width).mean(axis=1)
        size = float(np.abs(parts).max() * np.median(data.error))
        with np.errstate(divide="ignore"):
            of = np.abs([fit.value(FRICTION), fit.value("c") * data.sizes[-1]])
            effect = dict(zip((FRICTION, "c"), (size / of).tolist(), strict=True))
        yield Finding("other law of speed", {"size": size, "p": p}, effect)


def _rig(laws: Selection) -> Iterator[Finding]:
    """Yield findings on the other numbers of the law, and on those that steady speeds do not determine."""
    fit = laws.fit
    of = {name: (fit.value(name), fit.error(name)) for name in _UNITS}
    if fit.has("T_0"):
        yield Finding("offset", {"offset": of["T_0"]})
    if name := laws.best.name:
        yield Finding(_SHOWN[name], {symbol: of[symbol] for symbol in DEPARTURES[name]})
    if len(laws.models) > 1:
        weights = {name: laws.weight(symbol) for symbol, name in _LAWS.items()}
        weights["Stribeck"] = laws.weight("F_S") + laws.weight("exponential")
        yield Finding("laws of speed", weights)
    yield Finding("no K_z")


_SHOWN = {
    "F_S": "Stribeck",
    "exponential": "Stribeck",
    "v_0": "rounded at rest",
    "c_2": "quadratic damper",
}
