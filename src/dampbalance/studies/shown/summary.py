"""The table that a study asks for, of errors or of laws, and the page that shows it."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from ...arrays import Mask
from ...project.wording import in_markdown, listed, markdown_table, percent
from ..outputs import column_of, stretches, terms_of
from ..settings import EQUAL, RIGID, Fit, Study
from .confusion import confusion, confusion_markdown
from .statistics import Sizes, bounds_of, spread_of

WITHIN = 0.01  # relative error that the summary counts as good
SHARE = f"within_{100 * WITHIN:g}_percent_share"

Row = Mapping[Any, Any]


def summary_of(cases: str | Path, study: Study) -> pd.DataFrame:
    """The table that the study asks for: of errors, by the values of some axes or over all cases, or of laws."""
    if "chosen" in study.columns:
        return confusion(cases)
    return grouped_summary(cases, study) if study.summary_by else overall_summary(cases, study)


def overall_summary(cases: str | Path, study: Study) -> pd.DataFrame:
    """One row per fit and quantity: how many cases it could be identified in, and how large its error is, in %.

    Median and 95 % quantile of the error's size (to 0.06 % of themselves), its maximum, and the share of all cases
    with an error of at most WITHIN.
    """
    records, terms = [], terms_of(cases)
    for fit in study.fits:
        for quantity in (symbol for symbol in terms if symbol in fit.identified):
            # a column at a time: a file may have hundreds
            name = f"{quantity}_relative_error__{fit.label}"
            sizes = Sizes(WITHIN)
            for stretch in stretches(cases, [name]):
                sizes.add(stretch[name])
            how_large = {
                "cases": sizes.cases,
                "identified": sizes.known,
                "median_error_percent": 100.0 * sizes.quantile(0.5),
                "p95_error_percent": 100.0 * sizes.quantile(0.95),
                "max_error_percent": 100.0 * sizes.largest if sizes.known else math.nan,
                SHARE: sizes.share,
            }
            records.append(_which(quantity, fit) | how_large)
    return pd.DataFrame.from_records(records)


def grouped_summary(cases: str | Path, study: Study) -> pd.DataFrame:
    """One row per combination of values of `study.summary_by`, quantity and fit; shares of `Spread` in %.

    For noisy records, also the Cramér–Rao bound and the share of the information that is used, (bound/rms error)².
    """
    records = []
    for where, kept in groups(cases, study.summary_by):
        bounds = bounds_of(study, np.flatnonzero(kept))
        for quantity in terms_of(cases):
            for fit in (fit for fit in study.fits if quantity in fit.identified):
                errors = spread_of(study, cases, quantity, fit, kept)
                runs, identified, *shares = errors._asdict().items()
                record = {**where, **_which(quantity, fit), **dict([runs, identified])}
                record |= {f"{name}_percent": 100.0 * share for name, share in shares}
                record |= {"bias_over_standard_error": errors.bias / errors.standard_error}
                if study.route.has_intervals:
                    bound = bounds[quantity]
                    used = (bound / errors.rms) ** 2 if errors.rms > 0.0 else np.nan
                    record |= {"bound_percent": 100.0 * bound, "information_percent": 100.0 * used}
                records.append(record)
    return pd.DataFrame.from_records(records)


def groups(cases: str | Path, by: Sequence[str]) -> Iterator[tuple[dict[str, Any], Mask]]:
    """({axis: value}, which cases) for each combination of values of the axes `by`, in the order of the cases."""
    values = pd.DataFrame({name: column_of(cases, name) for name in by})
    for where in values.drop_duplicates().to_dict("records"):
        kept = (values == pd.Series(where)).all(axis=1).to_numpy()
        yield {str(name): value for name, value in where.items()}, kept


def _which(quantity: str, fit: Fit) -> dict[str, str]:
    """The columns of a table that identify the quantity and the fit of a row."""
    terms = {"terms": ", ".join(fit.terms)} if fit.terms else {}
    by = {"quantity": quantity, "approach": fit.approach, "phase": fit.phase}
    by |= {"sharing": fit.sharing, **terms, "contact": fit.contact}
    return by | {"weights": fit.weights, "fit": fit.kind}


def summary_markdown(study: Study, summary: pd.DataFrame, paragraph: str, figure: str) -> str:
    """A page to read: what was varied, what it shows, the figure, and the table of errors."""
    title = in_markdown(" ".join(study.title.split()))
    lines = [f"# {title}", ""]
    lines += [f"{study.cases:,} cases; varied: {', '.join(study.axis_names)}.", ""]
    lines += [in_markdown(paragraph), ""] if paragraph else []
    lines += [f"![{title}]({figure})", ""] if figure else []
    if "chosen" in study.columns:
        lines += confusion_markdown(summary)
    elif study.summary_by:
        lines += _grouped_markdown(study, summary)
    else:
        lines += _overall_markdown(summary)
    lines += ["", "All numbers: `cases.parquet`; what they are: `manifest.json`.", ""]
    return "\n".join(lines)


def _overall_markdown(summary: pd.DataFrame) -> list[str]:
    heads = ["identified", "median", "95 %", "largest", f"within {100 * WITHIN:g} %"]
    identified = listed(list(summary["quantity"].unique()))
    return [
        f"Size of the relative error over all cases in which {identified} could be identified.",
        "",
        _table_of_fits(heads, summary, _overall_cells),
    ]


def _overall_cells(row: Row) -> list[str]:
    return [
        f"{row['identified']:,}",
        *(_percent(row, f"{name}_error") for name in ("median", "p95", "max")),
        percent(row[SHARE]) if row["identified"] else "–",
    ]


def _grouped_markdown(study: Study, summary: pd.DataFrame) -> list[str]:
    """A table for each combination of values."""
    heads = ["identified", "bias", "scatter", "standard error"]
    heads += ["95 % of the errors below", "coverage"]
    lines = [
        f"Relative errors of the identified {listed(list(summary['quantity'].unique()))} over the runs. Scatter: their "
        "standard deviation. Standard error: what each run states, by bootstrap (`fit`: by its covariance), rms. "
        "Coverage: share of the 95 % intervals that hold the true value, and between which bounds the number of runs "
        "leaves it (95 %). ±: one standard error from the number of runs, of the 95 % quantile by Maritz and Jarrett."
    ]
    if study.route.has_intervals:
        heads += ["bound", "information"]
        lines[0] += (
            " Information: what the approach uses of that in the records, the square of the Cramér–Rao bound (m, k and "
            "the drive frequency known, K_z not) over the rms error."
        )
    for values, rows in summary.groupby(list(study.summary_by), sort=False):
        where = [
            f"{name} = {value if isinstance(value, str) else format(value, 'g')}"
            for name, value in zip(study.summary_by, values, strict=True)
        ]
        lines += ["", f"## {', '.join(where)}", "", _table_of_fits(heads, rows, _grouped_cells)]
    return lines


def _grouped_cells(row: Row) -> list[str]:
    sign = "−" if row["bias_percent"] < 0.0 else ""
    return [
        f"{row['identified']:,} of {row['runs']:,}",
        f"{sign}{_percent(row, 'bias')} ± {_percent(row, 'bias_error')}",
        _percent(row, "scatter"),
        *(f"{_percent(row, n)} ± {_percent(row, f'{n}_error')}" for n in ("standard_error", "p95")),
        f"{_percent(row, 'coverage')} ({_percent(row, 'coverage_low')} to {_percent(row, 'coverage_high')})",
        *(_percent(row, name) for name in ("bound", "information") if f"{name}_percent" in row),
    ]


def _table_of_fits(
    heads: Sequence[str], summary: pd.DataFrame, cells: Callable[[Row], Sequence[str]]
) -> str:
    """A table whose rows say which quantity and fit they are about; further columns hold numbers."""
    which = ("quantity", "approach", "phase", "φ, t_s", "fit")
    rows = []
    for row in summary.to_dict("records"):
        phase, fit = (row[name].replace("_", " ") for name in ("phase", "fit"))
        how = [row["approach"], *([row["terms"]] if row.get("terms") else [])]
        how += ["rigid"] if row["contact"] == RIGID else []
        how += ["equal weights"] if row["weights"] == EQUAL else []
        rows.append([row["quantity"], ", ".join(how), phase, row["sharing"], fit, *cells(row)])
    return markdown_table([*which, *heads], rows, "l" * len(which) + "r" * len(heads))


def _percent(row: Row, name: str) -> str:
    return percent(0.01 * row[f"{name}_percent"])
