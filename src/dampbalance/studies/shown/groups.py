"""Errors over many runs, grouped by the values of some axes: bias, scatter, stated standard error, coverage."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
import pyarrow.parquet as pq

from ...arrays import Array, Mask
from ...law.terms import KNOWN_TERMS
from ...project.wording import listed, markdown_table, percent
from ...solver import NORMAL_95
from ..settings import EQUAL, RIGID, Fit, Study
from ..stretches import column_of
from .bounds import bounds_of


class Spread(NamedTuple):
    """Statistics of an estimator over n runs. All except the counts are relative to the true value; NaN if unknown.

    bias : mean error.   bias_error : its standard error, scatter/√n.   scatter : standard deviation of the errors.
    rms : root of their mean square.   median, p95 : sizes that half and 95 % do not exceed; p95_error : standard error
    of the latter, see `quantile_error`.   standard_error : rms of the stated ones; standard_error_error : its own
    standard error.   coverage : share of the runs whose 95 % interval holds the true value;
    coverage_low, coverage_high : its 95 % interval, see `share_interval`.
    """

    runs: int
    identified: int
    bias: float
    bias_error: float
    scatter: float
    rms: float
    median: float
    p95: float
    p95_error: float
    standard_error: float
    standard_error_error: float
    coverage: float
    coverage_low: float
    coverage_high: float


def spread(errors: Array, standard_errors: Array | None, covered: Array | None) -> Spread:
    """The spread of relative errors; also of the stated standard errors and of the coverage, where there are any."""
    finite = errors[np.isfinite(errors)]
    n = len(finite)
    scatter = float(finite.std(ddof=1)) if n > 1 else np.nan
    judged = np.empty(0) if covered is None else covered[np.isfinite(covered)]
    low, high = share_interval(int(judged.sum()), len(judged))
    return Spread(
        runs=len(errors),
        identified=n,
        bias=float(finite.mean()) if n else np.nan,
        bias_error=scatter / np.sqrt(n) if n else np.nan,
        scatter=scatter,
        rms=_rms(finite),
        median=_reached(finite, 0.5),
        p95=_reached(finite, 0.95),
        p95_error=quantile_error(np.abs(finite), 0.95),
        standard_error=_rms(standard_errors),
        standard_error_error=_rms_error(standard_errors),
        coverage=_mean(covered),
        coverage_low=low,
        coverage_high=high,
    )


def quantile_error(values: Array, share: float) -> float:
    """Standard error of a quantile, the order statistic x_(k) of n independent values, k = ⌈share · n⌉ (Maritz and
    Jarrett): its standard deviation over all drawings of n values with replacement, without drawing any.

        P(x*_(k) ≤ x_(i)) = I_{i/n}(k, n − k + 1)   (the incomplete beta function)

    Good to 40 % from 50 values; NaN where the quantile is the largest value, for which this gives no error.
    """
    from scipy import special  # slow to import

    n, k = len(values), math.ceil(share * len(values))
    if k == n:
        return math.nan
    weights = np.diff(special.betainc(k, n - k + 1, np.arange(n + 1) / n))
    ordered = np.sort(values)
    return float(np.sqrt(weights @ (ordered - weights @ ordered) ** 2))


def share_interval(count: int, runs: int) -> tuple[float, float]:
    """The 95 % interval of a probability observed in `count` of `runs` (Wilson's score interval); NaN without a run.

    (p + z²/2n ± z √(p(1 − p)/n + z²/4n²)) / (1 + z²/n),   p = count/n, n = runs, z = 1.96
    """
    if runs == 0:
        return np.nan, np.nan
    share, z2 = count / runs, NORMAL_95**2 / runs
    half = np.sqrt(share * (1.0 - share) * z2 + 0.25 * z2 * z2)
    middle, whole = share + 0.5 * z2, 1.0 + z2
    return max(0.0, (middle - half) / whole), min(1.0, (middle + half) / whole)


def terms_of(cases: str | Path) -> list[str]:
    """Symbols of the terms whose errors the table of cases holds."""
    held = {column.partition("_relative_error__")[0] for column in pq.read_schema(cases).names}
    return [symbol for symbol in KNOWN_TERMS if symbol in held]


def spread_of(study: Study, cases: str | Path, quantity: str, fit: Fit, kept: Any = ...) -> Spread:
    """The spread of one quantity by one fit over the cases `kept` (an index or a mask; default: all)."""
    errors = column_of(cases, f"{quantity}_relative_error__{fit.label}")[kept]
    if "intervals" not in study.columns:
        return spread(errors, None, None)
    standard = column_of(cases, f"{quantity}_relative_standard_error__{fit.label}")[kept]
    return spread(errors, standard, column_of(cases, f"{quantity}_covered__{fit.label}")[kept])


def groups(
    study: Study, cases: str | Path, by: Sequence[str]
) -> Iterator[tuple[dict[str, Any], Mask]]:
    """({axis: value}, which cases) for each combination of values of the axes `by`, in the order of the cases."""
    values = pd.DataFrame({name: column_of(cases, name) for name in by})
    for combination in values.drop_duplicates().to_dict("records"):
        where = {str(name): value for name, value in combination.items()}
        yield where, (values[list(by)] == pd.Series(combination)).all(axis=1).to_numpy()


def grouped_summary(cases: str | Path, study: Study) -> pd.DataFrame:
    """One row per combination of values of `study.summary_by`, quantity and fit; shares of `Spread` in %.

    For noisy records, also the Cramér–Rao bound and the share of the information that is used, (bound/rms error)².
    """
    records = []
    for where, kept in groups(study, cases, study.summary_by):
        bounds = bounds_of(study, np.flatnonzero(kept))
        for quantity in terms_of(cases):
            for fit in (fit for fit in study.fits if quantity in fit.identified):
                errors = spread_of(study, cases, quantity, fit, kept)
                shares = errors._asdict()
                counts = {name: shares.pop(name) for name in ("runs", "identified")}
                record = {**where, **which(quantity, fit), **counts}
                record |= {f"{name}_percent": 100.0 * share for name, share in shares.items()}
                record |= {"bias_over_standard_error": errors.bias / errors.standard_error}
                if study.route.has_intervals:
                    bound = bounds[quantity]
                    used = (bound / errors.rms) ** 2 if errors.rms > 0.0 else np.nan
                    record |= {"bound_percent": 100.0 * bound, "information_percent": 100.0 * used}
                records.append(record)
    return pd.DataFrame.from_records(records)


def which(quantity: str, fit: Fit) -> dict[str, str]:
    """The columns of a table that identify the quantity and the fit of a row."""
    terms = {"terms": ", ".join(fit.terms)} if fit.terms else {}
    by = {"quantity": quantity, "approach": fit.approach, "phase": fit.phase}
    by |= {"sharing": fit.sharing, **terms, "contact": fit.contact}
    return by | {"weights": fit.weights, "fit": fit.kind}


def grouped_markdown(study: Study, summary: pd.DataFrame) -> list[str]:
    """The summary as Markdown: a table for each combination of values."""
    measured = study.route.has_intervals
    lines = [
        f"Relative errors of the identified {listed(list(summary['quantity'].unique()))} over the runs. Scatter: their "
        "standard deviation. Standard error: what each run states, by bootstrap (`fit`: by its covariance), rms. "
        "Coverage: share of the 95 % intervals that hold the true value, and between which bounds the number of runs "
        "leaves it (95 %). ±: one standard error from the number of runs, of the 95 % quantile by Maritz and Jarrett."
    ]
    if measured:
        lines[0] += (
            " Information: what the approach uses of that in the records, the square of the Cramér–Rao bound (m, k and "
            "the drive frequency known, K_z not) over the rms error."
        )
    heads = [*_HEADS, *(["bound", "information"] if measured else [])]
    for values, rows in summary.groupby(list(study.summary_by), sort=False):
        where = [
            f"{name} = {value if isinstance(value, str) else format(value, 'g')}"
            for name, value in zip(study.summary_by, values, strict=True)
        ]
        lines += ["", f"## {', '.join(where)}", ""]
        lines.append(table_of_fits(heads, map(_cells, rows.to_dict("records"))))
    return lines


FIT_HEADS = ("quantity", "approach", "phase", "φ, t_s", "fit")
_HEADS = (
    "identified",
    "bias",
    "scatter",
    "standard error",
    "95 % of the errors below",
    "coverage",
)


def table_of_fits(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table whose rows begin with `fit_cells`, under FIT_HEADS; further columns hold numbers."""
    return markdown_table([*FIT_HEADS, *heads], rows, "l" * len(FIT_HEADS) + "r" * len(heads))


def fit_cells(row: Mapping[Any, Any]) -> list[str]:
    """The cells under FIT_HEADS."""
    phase, fit = (row[name].replace("_", " ") for name in ("phase", "fit"))
    rigid = ", rigid" if row["contact"] == RIGID else ""
    equal = ", equal weights" if row["weights"] == EQUAL else ""
    terms = f", {row['terms']}" if row.get("terms") else ""
    return [row["quantity"], f"{row['approach']}{terms}{rigid}{equal}", phase, row["sharing"], fit]


def _cells(row: Mapping[Any, Any]) -> list[str]:
    sign = "−" if row["bias_percent"] < 0.0 else ""
    return [
        *fit_cells(row),
        f"{row['identified']:,} of {row['runs']:,}",
        f"{sign}{_percent(row, 'bias')} ± {_percent(row, 'bias_error')}",
        _percent(row, "scatter"),
        *(f"{_percent(row, n)} ± {_percent(row, f'{n}_error')}" for n in ("standard_error", "p95")),
        f"{_percent(row, 'coverage')} ({_percent(row, 'coverage_low')} to {_percent(row, 'coverage_high')})",
        *(_percent(row, name) for name in ("bound", "information") if f"{name}_percent" in row),
    ]


def _percent(row: Mapping[Any, Any], name: str) -> str:
    return percent(0.01 * row[f"{name}_percent"])


def _reached(errors: Array, share: float) -> float:
    """The smallest size among the errors that this share of them does not exceed, as `Sizes.quantile` has it."""
    if not len(errors):
        return np.nan
    return float(np.quantile(np.abs(errors), share, method="inverted_cdf"))


def _rms(values: Array | None) -> float:
    return float(np.sqrt(_mean(None if values is None else values**2)))


def _rms_error(values: Array | None) -> float:
    """Standard error of the rms of n independent values, s(x²)/(2 rms √n)."""
    squares = np.empty(0) if values is None else values[np.isfinite(values)] ** 2
    if len(squares) < 2 or not squares.any():
        return math.nan
    return float(squares.std(ddof=1) / (2.0 * np.sqrt(squares.mean() * len(squares))))


def _mean(values: Array | None) -> float:
    finite = np.empty(0) if values is None else values[np.isfinite(values)]
    return float(finite.mean()) if len(finite) else np.nan
