"""A table of the errors of every fit of a study, and the page that shows it."""

from __future__ import annotations

import math
from pathlib import Path

import pandas as pd

from ...project.wording import in_markdown, listed, percent
from ..settings import Study
from ..stretches import Sizes, stretches
from .confusion import confusion, confusion_markdown
from .groups import (
    fit_cells,
    grouped_markdown,
    grouped_summary,
    table_of_fits,
    terms_of,
    which,
)

WITHIN = 0.01  # relative error that the summary counts as good
SHARE = f"within_{100 * WITHIN:g}_percent_share"


def summary_of(cases: str | Path, study: Study) -> pd.DataFrame:
    """The table that the study asks for: of errors, by the values of some axes or over all cases, or of laws."""
    if study.route.chooses_law:
        return confusion(cases)
    return grouped_summary(cases, study) if study.summary_by else overall_summary(cases, study)


def overall_summary(cases: str | Path, study: Study) -> pd.DataFrame:
    """One row per fit and quantity: how many cases it could be identified in, and how large its error is, in %.

    Median and 95 % quantile of the error's size (to 0.06 % of themselves), its maximum, and the share of all cases
    with an error of at most WITHIN.
    """
    records = []
    terms = terms_of(cases)
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
            records.append(which(quantity, fit) | how_large)
    return pd.DataFrame.from_records(records)


def summary_markdown(study: Study, summary: pd.DataFrame, paragraph: str, figure: str) -> str:
    """A page to read: what was varied, what it shows, the figure, and the table of errors."""
    title = in_markdown(" ".join(study.title.split()))
    lines = [f"# {title}", ""]
    lines += [f"{study.cases:,} cases; varied: {', '.join(study.axis_names)}.", ""]
    lines += [in_markdown(paragraph), ""] if paragraph else []
    lines += [f"![{title}]({figure})", ""] if figure else []
    if study.route.chooses_law:
        lines += confusion_markdown(summary)
    elif study.summary_by:
        lines += grouped_markdown(study, summary)
    else:
        lines += _overall_markdown(summary)
    lines += ["", "All numbers: `cases.parquet`; what they are: `manifest.json`.", ""]
    return "\n".join(lines)


def _overall_markdown(summary: pd.DataFrame) -> list[str]:
    numbers = ("identified", "median", "95 %", "largest", f"within {100 * WITHIN:g} %")
    rows = [
        [
            *fit_cells(row),
            f"{row['identified']:,}",
            *(percent(0.01 * row[f"{name}_error_percent"]) for name in ("median", "p95", "max")),
            percent(row[SHARE]) if row["identified"] else "–",
        ]
        for row in summary.to_dict("records")
    ]
    identified = listed(list(summary["quantity"].unique()))
    return [
        f"Size of the relative error over all cases in which {identified} could be identified.",
        "",
        table_of_fits(numbers, rows),
    ]
