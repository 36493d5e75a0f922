"""An answer: numbers with their intervals and verdicts, and the rows of the balance that they come from.

Every approach to a kind of records ends in an `Answer`, and so does the maximum-likelihood fit; all answers to a set of
records make a `Result`. Tables, document, figures and studies read these alone, and do not depend on the kind of
records.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np

from ..arrays import Array
from ..balance import Rows
from ..findings.finding import Finding, grouped
from ..findings.words import Vocabulary, sentence
from ..fit.fit import OscillatorFit
from ..fit.select import Selection
from ..law.terms import FRICTION, term
from ..solver import NORMAL_95

CONFIDENCE = 0.95

_TRADES = 0.5  # correlation from which on the errors of two coefficients make up for each other
_ALL = 5.0  # times all of the work: a friction force that might dissipate that much has no limit

REFERENCE = "maximum likelihood"
"""Name of the answer of the fit to all records, as in `Result.approaches`."""

DIRECT, BALANCE = CHECKS = ("direct", "balance")
"""Names of the energy balance that checks the fit: of forced records by direct integration, and of free decays."""

USABLE, DOUBTFUL, NONE = "usable", "doubtful", "none"

USELESS = 0.05
"""Relative change of a number from which on its cause makes it doubtful: the difference between two careful
measurements of a damping, and half of the uncertainty that handbooks of damping state."""


class Interval(NamedTuple):
    """An interval that includes the true value with a probability of 95 %; an open end is infinite."""

    low: float
    high: float


@dataclass(frozen=True, slots=True)
class ParameterEstimate:
    """One identified number with its error, SI units; NaN where it could not be identified.

    standard_error : of the fit, or by the jackknife.
    interval : of 95 %.
    doubts : the findings that may change the number by more than its interval; empty for a usable one.
    bounded : whether the size of that change is known; the interval includes it then.
    """

    value: float
    standard_error: float
    interval: Interval
    doubts: tuple[Finding, ...] = ()
    bounded: bool = True

    @property
    def within(self) -> float:
        """Half the width of the interval, relative to the value; infinite where the error has no bound, NaN without a
        value."""
        if not self.bounded:
            return math.inf
        half = 0.5 * (self.interval.high - self.interval.low)
        return half / abs(self.value) if self.value else math.inf

    def at(self, value: float) -> ParameterEstimate:
        """Return the estimate at another value, with the same errors."""
        by = value - self.value
        low, high = self.interval
        return replace(self, value=value, interval=Interval(low + by, high + by))

    def averaged(self, normal: ParameterEstimate) -> ParameterEstimate:
        """Return the estimate with another value and a normally distributed error; each end of the interval lies
        farther out by the ratio by which it did for the normal error before."""
        if not (self.standard_error > 0.0 and math.isfinite(self.value)):
            return self
        reach, (low, high) = NORMAL_95 * self.standard_error, self.interval
        less, more = (self.value - low) / reach, (high - self.value) / reach
        value, ends = normal.value, normal.interval
        wider = Interval(value - less * (value - ends.low), value + more * (ends.high - value))
        return replace(self, value=value, standard_error=normal.standard_error, interval=wider)

    def wider(self, size: float) -> ParameterEstimate:
        """Return the estimate with a further independent error of this standard deviation, added in quadrature at
        either end of the interval."""
        if not (size > 0.0 and math.isfinite(self.value)):
            return self
        reach = NORMAL_95 * size
        low = self.value - math.hypot(self.value - self.interval.low, reach)
        high = self.value + math.hypot(self.interval.high - self.value, reach)
        error = math.hypot(self.standard_error, size)
        return replace(self, standard_error=error, interval=Interval(low, high))


UNKNOWN = ParameterEstimate(math.nan, math.nan, Interval(math.nan, math.nan))
"""The estimate of a number that the records do not determine."""


class Verdict(NamedTuple):
    """How far a number can be trusted.

    verdict : "usable" if nothing speaks against the interval; "doubtful" if a finding may change the number by more
    than its interval and 5 %, or by an unknown amount, or if the interval is wider than the number is large; "none" if
    there is no value.
    reason : in words, for a verdict other than usable, and for a number that is only a limit.
    within : half the width of the interval, relative to the value; infinite for a limit and where the error has no
    bound, NaN without a value.
    findings : those that decide the verdict.
    """

    verdict: str
    reason: str = ""
    within: float = math.nan
    findings: tuple[Finding, ...] = ()

    def worded(self, vocabulary: Vocabulary) -> Verdict:
        """Return the verdict with its reason in words, in the units of a coordinate."""
        return self._replace(
            reason="; ".join(sentence(g, vocabulary) for g in grouped(self.findings))
        )

    def document(self) -> dict[str, Any]:
        """Return the verdict by the keys of the document."""
        return {
            "verdict": self.verdict,
            "within_percent": 100.0 * self.within,
            "reason": self.reason,
        }


@dataclass(frozen=True, eq=False)
class Balance:
    """The rows of the energy balance of which an answer is the solution.

    errors : standard deviation of the misfit Σ g_j p_j − W of each row, J, (n,).
    names : the record or decay of each row.
    labels : further columns of a table of the rows.
    """

    rows: Rows
    errors: Array
    names: tuple[str, ...]
    labels: Mapping[str, Sequence[Any]] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Answer:
    """The numbers that one approach identifies, the maximum-likelihood fit or an energy balance.

    name : of the approach.
    parameters : the coefficients of the law (F_k in N, c in N s/m, …) and K_z, N/m, by symbol.
    covariance : of their errors, in the order of `parameters`, (n, n), in the products of their units; NaN where it is
    not known.
    notes : findings on this answer: what limits its numbers, and why one is missing.
    balance : the rows that were solved; None for the fit.
    merit : goodness of fit and the further numbers of the fit, by the keys of the document.
    rig : the moving mass (m, kg), its natural frequency with the contact loose (f_n, Hz) and the damping ratio of c
    (zeta); empty where no fit determines the mass.
    judged : whether it has verdicts; a check has none.
    """

    name: str
    parameters: Mapping[str, ParameterEstimate]
    covariance: Array
    notes: tuple[Finding, ...] = ()
    balance: Balance | None = None
    merit: Mapping[str, Any] = field(default_factory=dict)
    rig: Mapping[str, ParameterEstimate] = field(default_factory=dict)
    judged: bool = True

    def as_check(self) -> Answer:
        """Return the coefficients with their errors alone, without verdicts, as the check of another answer."""
        own = self.coefficients
        covariance = self.covariance[: len(own), : len(own)]  # K_z last
        return replace(self, parameters=own, covariance=covariance, notes=(), judged=False)

    @property
    def coefficients(self) -> dict[str, ParameterEstimate]:
        """The parameters of the law, without K_z."""
        return {symbol: p for symbol, p in self.parameters.items() if symbol != "K_z"}

    @property
    def K_z(self) -> ParameterEstimate:
        """The contact stiffness, N/m, whose interval follows from that of K_z^{−1/2}."""
        return self.parameters["K_z"]

    @property
    def values(self) -> dict[str, float]:
        """Each value by its symbol, SI units."""
        return {symbol: p.value for symbol, p in self.parameters.items()}

    @property
    def standard_errors(self) -> dict[str, float]:
        """Each standard error by its symbol, SI units."""
        return {symbol: p.standard_error for symbol, p in self.parameters.items()}

    @property
    def intervals(self) -> dict[str, Interval]:
        """The 95 % interval of each value by its symbol, SI units."""
        return {symbol: p.interval for symbol, p in self.parameters.items()}

    @property
    def verdicts(self) -> dict[str, Verdict]:
        """The verdict on each value by its symbol; empty for a check.

        A coefficient that may be zero is an upper limit. The limit is usable if a coefficient whose error is correlated
        with its own is known within 5 %, which it could not be if more friction went unnoticed.
        """
        if not self.judged:
            return {}
        verdicts = {s: judged(s, p, self.notes) for s, p in self.parameters.items()}
        errors = np.sqrt(np.diag(self.covariance))
        with np.errstate(divide="ignore", invalid="ignore"):
            trade = np.abs(self.covariance / np.outer(errors, errors)) >= _TRADES
        for (symbol, p), trades in zip(self.coefficients.items(), trade, strict=False):  # K_z last
            others = itertools.compress(self.coefficients, trades)
            sure = any(
                verdicts[s].verdict == USABLE and verdicts[s].within <= USELESS for s in others
            )
            if p.interval.low <= 0.0 < p.interval.high and not p.doubts and p.bounded and sure:
                only = Finding("upper limit", {"limits": ((symbol, *p.interval),)})
                verdicts[symbol] = Verdict(USABLE, within=math.inf, findings=(only,))
        return verdicts

    @property
    def answered(self) -> bool:
        """Whether at least one coefficient has a value with a bounded error."""
        return any(math.isfinite(self.verdicts[symbol].within) for symbol in self.coefficients)

    @property
    def misfit(self) -> float:
        """χ² of the rows about the solution per degree of freedom; NaN where there is no degree of freedom left."""
        return float(self.merit.get("misfit", math.nan))

    @property
    def rows(self) -> dict[str, Array]:
        """The rows of the balance by column, (rows,): the integrals, the input work W, its standard error, and the
        misfit of the identified values; empty for the fit."""
        if self.balance is None:
            return {}
        rows = self.balance.rows
        columns = {term(key).integral_column: g for key, g in rows.terms.items()}
        columns |= {"W_J": rows.W, "standard_error_J": self.balance.errors}
        return columns | {"misfit_J": self.row_misfit}

    @property
    def row_misfit(self) -> Array:
        """Σ g_j p_j − W of each row with the values of this answer, J, (rows,)."""
        assert self.balance is not None
        rows = self.balance.rows
        own = {s: p.value for s, p in self.coefficients.items() if s in rows.terms}
        return rows.misfit({**rows.given, **own})


def answer_of_fit(
    fit: OscillatorFit,
    coefficients: Iterable[str],
    notes: Iterable[Finding],
    **merit: Any,
) -> Answer:
    """Return the answer of a fit of maximum likelihood.

    coefficients : keys.   merit : what else the fit identifies.
    """
    keys = list(coefficients)
    numbers = {key: (fit.value(key), fit.error(key), fit.interval(key)) for key in keys}
    numbers["K_z"] = fit.K_z, fit.K_z_error, fit.K_z_interval
    parameters = {
        key: ParameterEstimate(value, error, Interval(*ends))
        for key, (value, error, ends) in numbers.items()
    }
    forces = [p for key, p in parameters.items() if key.partition("[")[0] == FRICTION]
    frictionless = forces and all(p.interval.low <= 0.0 for p in forces)
    if frictionless and math.isinf(parameters["K_z"].interval.high):
        parameters["K_z"] = UNKNOWN  # a contact without friction has any stiffness
    # K_z = ρ^{−2}, dK_z = −2ρ^{−3} dρ
    slopes = [1.0] * len(keys) + [-2.0 * fit.K_z**1.5]
    with np.errstate(invalid="ignore"):
        covariance = fit.covariance_of(*keys, "rho") * np.outer(slopes, slopes)
    of_fit = {
        "m_kg": fit.m,
        "m_standard_error_kg": fit.error("m"),
        "natural_frequency_Hz": fit.natural_frequency_hz,
        "misfit": fit.misfit,
    }
    return Answer(REFERENCE, parameters, covariance, tuple(notes), merit=of_fit | merit)


def averaged(answer: Answer, selection: Selection) -> Answer:
    """Return the answer of the heaviest fit with numbers and errors averaged over all models that were weighed. Each
    number is the weighted median, which a model of little weight hardly changes, however far it lies from the others.

    selection : its numbers are coefficients, ρ of the contact and m.
    """
    of = _estimates(selection)
    parameters = {s: p.averaged(of[s]) if s in of else p for s, p in answer.parameters.items()}
    if "rho" in of:
        parameters["K_z"] = _averaged_stiffness(answer.K_z, of["rho"])
    covariance = covariance_in(
        selection, [*parameters], of["rho"].value if "rho" in of else math.nan
    )
    merit, rig = dict(answer.merit), answer.rig
    if "m" in of and "m_kg" in merit:
        # an m that the models leave open, even its sign, stays that of the fit
        m = of["m"]
        if m.standard_error < m.value:
            merit["natural_frequency_Hz"] *= math.sqrt(merit["m_kg"] / m.value)
            merit |= {"m_kg": m.value, "m_standard_error_kg": m.standard_error}
        else:
            selection = replace(selection, models=(selection.best,), weights=(1.0,))
        rig = rig_of(selection)
    return replace(answer, parameters=parameters, covariance=covariance, merit=merit, rig=rig)


def rig_of(selection: Selection) -> dict[str, ParameterEstimate]:
    """Return m, f_n = √(k/m)/2π and ζ = c/(2√(km)), with standard errors and intervals of all models that were weighed:
    the values of each, and their covariance to first order in c, m and k.

    selection : its numbers are c, m and k, those of them that are not given.
    """
    fit, models, weights = selection.fit, [], []
    for model, weight in zip(selection.models, selection.weights, strict=True):
        own = dict(zip(selection.keys, model.values.tolist(), strict=True))
        c, m = own.get("c", 0.0), own.get("m", fit.value("m"))
        k = own.get("k") or fit.k
        if m > 0.0:  # a light model may have none
            f_n, critical = math.sqrt(k / m) / (2.0 * math.pi), 2.0 * math.sqrt(k * m)
            zeta = c / critical
            by = {"c": (0.0, 0.0, 1.0 / critical), "m": (1.0, -0.5 * f_n / m, -0.5 * zeta / m)}
            by |= {"k": (0.0, 0.5 * f_n / k, -0.5 * zeta / k)}
            slopes = np.array([by.get(key, (0.0, 0.0, 0.0)) for key in selection.keys])
            covariance = slopes.T @ model.covariance @ slopes
            models.append(replace(model, values=np.array([m, f_n, zeta]), covariance=covariance))
            weights.append(weight)
    if not models:
        return {}
    shares = tuple(weight / math.fsum(weights) for weight in weights)
    of = replace(selection, keys=("m", "f_n", "zeta"), models=tuple(models), weights=shares)
    return {s: p for s, p in _estimates(of).items() if s != "zeta" or "c" in selection.keys}


def _estimates(selection: Selection) -> dict[str, ParameterEstimate]:
    """Return the median of each number over all models, with its standard error and interval."""
    errors = np.sqrt(np.diag(selection.covariance)).tolist()
    return {
        key: ParameterEstimate(
            selection.interval(key, 0.0)[0], error, Interval(*selection.interval(key))
        )
        for key, error in zip(selection.keys, errors, strict=True)
    }


def _averaged_stiffness(K_z: ParameterEstimate, rho: ParameterEstimate) -> ParameterEstimate:
    """Return a contact stiffness with the value and error of ρ = K_z^{−1/2} over all models."""
    if not (math.isfinite(K_z.value) and K_z.standard_error > 0.0 and rho.value > 0.0):
        return K_z
    value = K_z.value**-0.5
    low, high = (end**-0.5 if end > 0.0 else math.inf for end in K_z.interval[::-1])
    error = 0.5 * K_z.standard_error * value**3
    own = replace(K_z, value=value, standard_error=error, interval=Interval(low, high))
    return stiffness_of(own.averaged(rho))


def stiffness_of(rho: ParameterEstimate) -> ParameterEstimate:
    """Return K_z = ρ^{−2}, N/m; its interval comes from that of ρ, and is unbounded above where that reaches zero."""
    low, high = rho.interval
    return replace(
        rho,
        value=rho.value**-2,
        standard_error=2.0 * rho.standard_error * rho.value**-3,
        interval=Interval(high**-2, low**-2 if low > 0.0 else math.inf),
    )


def covariance_in(selection: Selection, symbols: Sequence[str], rho: float) -> Array:
    """Return the covariance of the errors of numbers by symbol, over all models; K_z = ρ^{−2} to first order."""
    at = [selection.keys.index("rho" if s == "K_z" else s) for s in symbols]
    slopes = [-2.0 * max(rho, 1e-90) ** -3 if s == "K_z" else 1.0 for s in symbols]
    with np.errstate(over="ignore", invalid="ignore"):
        return np.asarray(selection.covariance[np.ix_(at, at)] * np.outer(slopes, slopes))


def covariance_of(
    parameters: Mapping[str, ParameterEstimate], symbols: Sequence[str], known: Array
) -> Array:
    """Return the covariance of the errors of all parameters from that of some, by symbol; NaN where it is not known."""
    matrix = np.full((len(parameters), len(parameters)), np.nan)
    np.fill_diagonal(matrix, [p.standard_error**2 for p in parameters.values()])
    at = [[*parameters].index(symbol) for symbol in symbols]
    matrix[np.ix_(at, at)] = 0.5 * (known + known.T)  # products of matrices round unlike
    return matrix


def judged(symbol: str, parameter: ParameterEstimate, notes: tuple[Finding, ...] = ()) -> Verdict:
    """Return the verdict on a number by itself.   notes : why it is missing, for the verdict "none"."""
    if math.isnan(parameter.value):
        return Verdict(NONE, findings=notes or (Finding("undetermined", {"symbol": symbol}),))
    low, high = parameter.interval
    why, within = list(parameter.doubts), parameter.within
    if math.isinf(parameter.value) or math.isinf(high):
        why.append(Finding("lower limit", {"limits": ((symbol, low, high),)}))
        within = math.inf
    elif not high - low <= abs(parameter.value):
        why.append(Finding("wide", {"symbol": symbol}))
    return Verdict(DOUBTFUL if why else USABLE, within=within, findings=tuple(why))


def doubted(answers: Mapping[str, Answer], warnings: Sequence[Finding]) -> dict[str, Answer]:
    """Return the answers with the possible effects of their notes and of the warnings: each interval is widened by
    them, and a number is doubted if they exceed both its interval and `USELESS`, or are unknown. A number that may be
    zero is undetermined if its upper limit is infinite or, for friction, beyond all of the work."""
    most = {
        key: _ALL * float(np.max(rows.W[a > 0.0] / a[a > 0.0], initial=0.0)) or math.inf
        for rows in (one.balance.rows for one in answers.values() if one.balance is not None)
        for key, a in rows.terms.items()
        if term(key).symbol == FRICTION
    }
    return {
        name: _doubted(answer, [*(w for w in warnings if not w.spares(name)), *answer.notes], most)
        for name, answer in answers.items()
    }


def _doubted(answer: Answer, findings: Iterable[Finding], most: Mapping[str, float]) -> Answer:
    """Return the answer with the possible effects of findings on its numbers.   most : the largest friction force that
    counts as a limit."""
    kinds = grouped([one for one in findings if one.effect])
    parameters = {s: _shifted(s, p, kinds) for s, p in answer.parameters.items()}
    # units and gains move no frequency
    of_rig = {"f_n": [of for of in kinds if math.isinf(max(one.shift("") for one in of))]}
    rig = {
        s: _shifted("c" if s == "zeta" else s, p, of_rig.get(s, kinds))
        for s, p in answer.rig.items()
    }
    for s, p in parameters.items():
        if p.interval.low <= 0.0 and p.interval.high >= most.get(s, math.inf):
            parameters[s] = UNKNOWN
    # which way a shift goes is not known: it correlates nothing
    pairs = zip(parameters.values(), answer.parameters.values(), strict=True)
    added = np.diag([p.standard_error**2 - own.standard_error**2 for p, own in pairs])
    covariance = answer.covariance + np.nan_to_num(added)
    return replace(answer, parameters=parameters, covariance=covariance, rig=rig)


def _shifted(
    symbol: str, p: ParameterEstimate, kinds: Sequence[Sequence[Finding]]
) -> ParameterEstimate:
    """Return a number with the possible effect of findings: the largest shift of each kind, all kinds in quadrature."""
    shifts = [max(one.shift(symbol) for one in of) for of in kinds]
    total = math.hypot(*shifts)
    bounded = total < 1.0  # a shift of 100 % or more bounds nothing
    doubts = p.doubts
    if not (bounded and total <= max(USELESS, p.within)):
        # those without a bound, or the one with the largest effect
        worst = max(shifts)
        doubts += tuple(
            one for of, shift in zip(kinds, shifts, strict=True) if shift == worst for one in of
        )
    wider = p.wider(total * abs(p.value) / NORMAL_95) if bounded else p
    return replace(wider, doubts=doubts, bounded=bounded and p.bounded)
