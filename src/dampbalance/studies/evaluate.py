"""One chunk of a study: cases → responses → rows → estimates, whole arrays at a time."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd

from ..arrays import Array, Integers, Words
from ..balance import TERMS, Rows, approach, direct
from ..features import Features, of_orbits
from ..motion.orbits import steady_orbits
from ..replication.read_out import ReadOut
from ..solver import NORMAL_95, Estimate, solve
from .cases import (
    NOT_READ,
    PART,
    REGIME_NAMES,
    Cases,
    Responses,
    case_columns,
    cases_between,
    identified_by,
)
from .parameters import SI_COLUMNS, of_law, parameter
from .study_file import LIKELIHOOD, RIGID, SIMPSON, WEIGHTED, Estimator, Study

READ = (
    *("X", "X_s", "X_r", "V_s", "V_r", "t_s", "t_r", "phi"),
    *("phi_fundamental", "X_1", "X_3", "X_5"),
)
"""The features that rules of reading change, as far as the rows need them."""

_SLICE = 16_384  # cases worked on at a time: their arrays stay in the processor's cache


def evaluate(study: Study, start: int, stop: int, threads: int | None = None) -> pd.DataFrame:
    """Return the cases start … stop − 1 of a study as a table with the columns of `case_columns`.

    threads : for the exact orbits. The numbers depend neither on them nor on start and stop.
    """
    parts = [_evaluate(cases, threads) for cases in _slices(study, start, stop)]
    names = [column.name for column in case_columns(study)]
    columns = {name: np.concatenate([part[name] for part in parts]) for name in names}
    return pd.DataFrame(columns, copy=False)  # one block of all columns would take a copy


def in_parts(
    study: Study, start: int, stop: int, threads: int | None = None
) -> Iterator[pd.DataFrame]:
    """Evaluate like `evaluate`, PART cases at a time, so that memory does not grow with the number of cases."""
    for first in range(start, stop, PART):
        yield evaluate(study, first, min(first + PART, stop), threads)


def responses_of(study: Study, start: int, stop: int, threads: int | None = None) -> pd.DataFrame:
    """Return the responses of the cases start … stop − 1, from which `evaluate` identifies.

    The table has a row for each case and level: the axes, the level counted from 1 and the features, names with units.
    """
    parts = []
    for cases in _slices(study, start, stop):
        levels, count = cases.Y.shape
        columns = {"case": cases.numbers} | {name: cases.values[name] for name in study.axis_names}
        table: dict[str, Any] = {name: np.repeat(x, levels) for name, x in columns.items()}
        table["level"] = np.tile(np.arange(levels) + 1, count)
        seen = _responses(cases, threads).features.to_columns()
        table |= {name: np.asarray(column).T.ravel() for name, column in seen.items()}
        table["regime"] = np.array([REGIME_NAMES.get(word, NOT_READ) for word in table["regime"]])
        parts.append(pd.DataFrame(table))
    return pd.concat(parts, ignore_index=True)


def _slices(study: Study, start: int, stop: int) -> Iterator[Cases]:
    for first in range(start, stop, _SLICE):
        yield cases_between(study, first, min(first + _SLICE, stop))


def _evaluate(cases: Cases, threads: int | None) -> dict[str, Any]:
    study, values, si = cases.study, cases.values, cases.si
    responses, rules = _responses(cases, threads), _read_out_rules(values)
    table: dict[str, Any] = {name: si[key] for key, name in SI_COLUMNS.items()}
    table |= {name: si[key] for name, key in of_law(values).items()}
    table |= {"case": cases.numbers} | {name: values[name] for name in study.axis_names}
    table["regime"] = _regime_names(responses.features.regime)
    cached: dict[Estimator, Rows] = {}
    for fit in study.fits:
        table[f"residual__{fit.label}"] = np.full(len(cases.numbers), np.nan)
        if fit.approach == LIKELIHOOD:
            values, errors = ({s: x[s] for s in fit.identified} for x in responses.likelihood)
            table |= _results(fit, values, errors, si)
            continue
        read, replicates = responses.features, responses.drawn
        if fit.approach == SIMPSON:
            read, replicates = responses.simpson
        key, errors = replace(fit, weights="", levels=None), dict[str, Array]()
        if key not in cached:
            cached[key] = _rows(fit, read, si["k"], rules)
        of_levels = slice(None) if fit.levels is None else list(fit.levels)
        rows = cached[key][of_levels]
        if replicates is None:
            estimate = solve(rows)
        else:
            drawn = _rows(fit, replicates, si["k"][:, None], ())[of_levels]
            estimate, errors = _with_errors(rows, drawn, fit.weights == WEIGHTED)
        if len(rows.W) > len(estimate.values):  # otherwise the residual is mere rounding
            table[f"residual__{fit.label}"] = estimate.residual
        table |= _results(fit, estimate.values, errors, si)
    return table


def _with_errors(rows: Rows, drawn: Rows, weighted: bool) -> tuple[Estimate, dict[str, Array]]:
    """Return the estimate from rows, weighted by the scatter of replicates or not, and its standard errors.

    These come from the replicates, which take the weights of the rows.
    """
    if weighted:
        rows = replace(rows, covariance=drawn.scatter())
    estimate = solve(rows)
    if weighted:
        weights = rows.weighted(estimate.values).weights
        assert weights is not None
        drawn = replace(drawn, weights=np.broadcast_to(weights[..., None], drawn.W.shape))
    return estimate, {s: values.std(axis=1, ddof=1) for s, values in solve(drawn).values.items()}


def _results(
    fit: Estimator,
    estimates: Mapping[str, Array],
    errors: Mapping[str, Array],
    si: Mapping[str, Array],
) -> dict[str, Array]:
    """Return the columns of a fit: coefficients and their relative errors; with standard errors also these, and whether
    estimate ± 1.96 standard errors holds the true value."""
    table = {}
    for symbol, value in estimates.items():
        table[f"{identified_by(symbol).column}__{fit.label}"] = value
        if symbol not in si:  # a term that the oscillator does not have
            continue
        true = np.where(si[symbol] > 0.0, si[symbol], np.nan)  # zero has no relative error
        table[f"{symbol}_relative_error__{fit.label}"] = value / true - 1.0
        if symbol in errors:
            error = errors[symbol]
            covered = np.where(np.abs(value - si[symbol]) <= NORMAL_95 * error, 1.0, 0.0)
            judged = np.isfinite(value) & np.isfinite(error)
            table[f"{symbol}_relative_standard_error__{fit.label}"] = error / true
            table[f"{symbol}_covered__{fit.label}"] = np.where(judged, covered, np.nan)
    return table


def _responses(cases: Cases, threads: int | None) -> Responses:
    """Return the responses of the cases; all except the exact ones are computed one after the other, by `responses`."""
    si, study = cases.si, cases.study
    terms = {symbol for fit in study.fits for symbol in fit.terms} - TERMS.keys()
    if study.route.kind == "exact" and not terms and not of_law(cases.values):
        args: dict[str, Any] = {name: si[name] for name in ("m", "c", "k", "K_z", "F_k", "omega")}
        return Responses(
            of_orbits(steady_orbits(**args, Y=cases.Y, threads=threads), cases.Y, si["omega"])
        )
    from .responses import ROUTES_TO_RESPONSES  # slow to import

    return ROUTES_TO_RESPONSES[study.route.kind](cases, terms)


def _rows(
    fit: Estimator, responses: Features, k: Array, rules: Sequence[tuple[Integers, ReadOut]]
) -> Rows:
    """Return the rows of the balance that the approach of a fit forms from features.

    Each case is rounded by its rules; where the fit wants φ and t_s common, all levels have their mean.
    """
    if fit.approach == SIMPSON:
        return direct(responses, k)
    seen = responses.with_phase(fit.phase) if fit.phase else responses
    common = fit.sharing == "common"
    if rules:
        changed = {name: np.empty(seen.X.shape) for name in READ}
        for cases, read_out in rules:
            rule = read_out.common if common else read_out.apply
            read = rule(seen[:, cases])
            for name, array in changed.items():
                array[:, cases] = getattr(read, name)
        seen = seen.replaced(**changed)
    elif common:
        seen = seen.with_common("phi", "t_s")
    if fit.contact == RIGID:
        seen = seen.rigid()
    return approach(fit.approach)(seen, k, fit.terms or None)


def _read_out_rules(values: Mapping[str, Words]) -> list[tuple[Integers, ReadOut]]:
    """Return (cases, rules of reading) for each different set of rules among the cases; empty without rules."""
    names = [name for name in values if parameter(name).kind == "read_out"]
    rules = []
    if names:
        frame = pd.DataFrame({name: values[name].astype(float) for name in names})
        for row, cases in frame.groupby(names):
            pairs = zip(names, np.array(row).tolist(), strict=True)
            section = {name: int(x) if parameter(name).whole else x for name, x in pairs}
            rules.append((cases.index.to_numpy(), ReadOut.from_config(section)))
    return rules


def _regime_names(words: Words) -> Words:
    """Return the regime of each case: one name if all levels are alike, else the names of all levels."""
    of_levels = pd.DataFrame(words.T)
    pattern = of_levels.groupby([*of_levels], sort=False).ngroup().to_numpy()
    _, first = np.unique(pattern, return_index=True)
    names = []
    for case in words[:, first].T:
        regimes = [REGIME_NAMES.get(word, NOT_READ) for word in case]
        names.append(regimes[0] if len(set(regimes)) == 1 else ", ".join(regimes))
    return np.array(names, dtype=object)[pattern]
