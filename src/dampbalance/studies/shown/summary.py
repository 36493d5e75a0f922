"""The table of errors of a study, and the page that shows it."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import pandas as pd

from ...project.wording import in_markdown, listed, markdown_table, percent, signed_percent
from ..case_files import column_of, terms_of
from ..study_file import EQUAL, LIKELIHOOD, RIGID, Estimator, Study
from .statistics import Sizes, bounds_of, groups, spread_of

WITHIN = 0.01  # relative error that the summary counts as good
SHARE = f"within_{100 * WITHIN:g}_percent_share"

SummaryRow = Mapping[Any, Any]


def summary_of(cases: str | Path, study: Study) -> pd.DataFrame:
    """Return the table of errors that the study asks for: by the values of some axes, or over all cases."""
    records = _grouped_records if study.summary_by else _overall_records
    return pd.DataFrame.from_records(list(records(cases, study)))


def _overall_records(cases: str | Path, study: Study) -> Iterator[dict[str, Any]]:
    """Yield one row per fit and quantity: how many cases it could be identified in, and how large its error is, in %.

    Median and 95 % quantile of the error's size (to a relative 0.06 %), its maximum, and the share of all cases
    with an error of at most WITHIN.
    """
    terms = terms_of(cases)
    for fit in study.fits:
        for quantity in (symbol for symbol in terms if symbol in fit.identified):
            # a column at a time: a file may have hundreds
            errors = column_of(cases, f"{quantity}_relative_error__{fit.label}")
            sizes = Sizes(errors, WITHIN)
            yield _which(quantity, fit) | {
                "cases": sizes.cases,
                "identified": sizes.known,
                "median_error_percent": 100.0 * sizes.quantile(0.5),
                "p95_error_percent": 100.0 * sizes.quantile(0.95),
                "max_error_percent": 100.0 * sizes.largest if sizes.known else math.nan,
                SHARE: sizes.share,
            }


def _grouped_records(cases: str | Path, study: Study) -> Iterator[dict[str, Any]]:
    """Yield one row per combination of values of `study.summary_by`, quantity and fit; shares of `spread` in %.

    For noisy records, also the Cramér–Rao bound and the share of the information that is used, (bound/rms error)².
    """
    for where, kept in groups(cases, study.summary_by):
        bounds = bounds_of(study, kept)
        for quantity in terms_of(cases):
            for fit in (fit for fit in study.fits if quantity in fit.identified):
                errors = spread_of(study, cases, quantity, fit, kept)
                ratio = errors["bias"] / errors["standard_error"]
                counts = {name: errors.pop(name) for name in ("runs", "identified")}
                record = where | _which(quantity, fit) | counts
                record |= {f"{name}_percent": 100.0 * share for name, share in errors.items()}
                record |= {"bias_over_standard_error": ratio}
                if study.route.is_noisy:
                    bound, rms = bounds[quantity], errors["rms"]
                    used = (bound / rms) ** 2 if rms > 0.0 else math.nan
                    record |= {"bound_percent": 100.0 * bound, "information_percent": 100.0 * used}
                yield record


def _which(quantity: str, fit: Estimator) -> dict[str, str]:
    """Return the columns of a table that identify the quantity and the fit of a row."""
    terms = {"terms": ", ".join(fit.terms)} if fit.terms and fit.approach != LIKELIHOOD else {}
    by = {"quantity": quantity, "approach": fit.approach, "phase": fit.phase}
    by |= {"sharing": fit.sharing, **terms, "contact": fit.contact}
    return by | {"weights": fit.weights, "fit": fit.kind}


# --- the page ----------------------------------------------------------------------------------------


def summary_markdown(study: Study, summary: pd.DataFrame, paragraph: str, figure: str) -> str:
    """Return a page to read: what was varied, what it shows, the figure, and the table of errors."""
    title = in_markdown(" ".join(study.title.split()))
    lines = [f"# {title}", ""]
    lines += [f"{study.cases:,} cases; varied: {', '.join(study.axis_names)}.", ""]
    lines += [in_markdown(paragraph), ""] if paragraph else []
    lines += [f"![{title}]({figure})", ""] if figure else []
    if study.summary_by:
        lines += _grouped_markdown(study, summary)
    else:
        identified = listed(list(summary["quantity"].unique()))
        lines += [
            f"Size of the relative error over all cases in which {identified} could be identified."
        ]
        heads = ["identified", "median", "95 %", "largest", f"within {100 * WITHIN:g} %"]
        lines += ["", _table_of_fits(heads, summary, _overall_cells)]
    lines += ["", "All numbers: `cases.parquet`; what they are: `manifest.json`.", ""]
    return "\n".join(lines)


def _overall_cells(row: SummaryRow) -> list[str]:
    return [
        f"{row['identified']:,}",
        *(_percent(row, f"{name}_error") for name in ("median", "p95", "max")),
        percent(row[SHARE]) if row["identified"] else "–",
    ]


def _grouped_markdown(study: Study, summary: pd.DataFrame) -> list[str]:
    """Return a table for each combination of values."""
    heads = ["identified", "bias", "scatter", "standard error"]
    heads += ["95 % of the errors below", "coverage"]
    lines = [
        f"Relative errors of the identified {listed(list(summary['quantity'].unique()))} over the runs. Scatter: their "
        "standard deviation. Standard error: what each run states, by bootstrap (`fit`: by its covariance), rms. "
        "Coverage: share of the 95 % intervals that hold the true value, and between which bounds the number of runs "
        "leaves it (95 %). ±: one standard error from the number of runs, of the 95 % quantile by Maritz and Jarrett."
    ]
    if study.route.is_noisy:
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


def _grouped_cells(row: SummaryRow) -> list[str]:
    return [
        f"{row['identified']:,} of {row['runs']:,}",
        f"{signed_percent(0.01 * row['bias_percent'], plus='')} ± {_percent(row, 'bias_error')}",
        _percent(row, "scatter"),
        *(f"{_percent(row, n)} ± {_percent(row, f'{n}_error')}" for n in ("standard_error", "p95")),
        _with_interval(row, "coverage"),
        *(_percent(row, name) for name in ("bound", "information") if f"{name}_percent" in row),
    ]


def _table_of_fits(
    heads: Sequence[str], summary: pd.DataFrame, cells: Callable[[SummaryRow], Sequence[str]]
) -> str:
    """Return a table whose rows say which quantity and fit they are about; further columns hold numbers."""
    which = ("quantity", "approach", "phase", "φ, t_s", "fit")
    rows = []
    for row in summary.to_dict("records"):
        phase, fit = (row[name].replace("_", " ") for name in ("phase", "fit"))
        how = [row["approach"], *([row["terms"]] if row.get("terms") else [])]
        how += ["rigid"] if row["contact"] == RIGID else []
        how += ["equal weights"] if row["weights"] == EQUAL else []
        rows.append([row["quantity"], ", ".join(how), phase, row["sharing"], fit, *cells(row)])
    return markdown_table([*which, *heads], rows, "l" * len(which) + "r" * len(heads))


def _with_interval(row: SummaryRow, name: str) -> str:
    """Return a share with the bounds of its 95 % interval."""
    return "{} ({} to {})".format(*(_percent(row, name + end) for end in ("", "_low", "_high")))


def _percent(row: SummaryRow, name: str) -> str:
    return percent(0.01 * row[f"{name}_percent"])
