"""A table of the errors of every fit of a study, and the page that shows it."""

from __future__ import annotations

from pathlib import Path

import pandas as pd

from ...project.wording import percent
from ..settings import Study
from ..stretches import Sizes, stretches
from .groups import fit_cells, grouped_markdown, grouped_summary

WITHIN = 0.01  # relative error that the summary counts as good
SHARE = f"within_{100 * WITHIN:g}_percent_share"


def summary_of(cases: str | Path, study: Study) -> pd.DataFrame:
    """The table of errors that the study asks for: by the values of some axes, or over all cases."""
    return grouped_summary(cases, study) if study.summary_by else overall_summary(cases, study)


def overall_summary(cases: str | Path, study: Study) -> pd.DataFrame:
    """One row per fit and quantity: how many cases it could be identified in, and how large its error is, in %.

    Median and 95 % quantile of the error's size (to 0.06 % of themselves), its maximum, and the share of all cases
    with an error of at most WITHIN.
    """
    names = {
        (fit, quantity): f"{quantity}_relative_error__{fit.label}"
        for fit in study.fits
        for quantity in ("F_k", "c")
    }
    sizes = {key: Sizes(WITHIN) for key in names}
    for key, name in names.items():  # a column at a time: a file may have hundreds
        for stretch in stretches(cases, [name]):
            sizes[key].add(stretch[name])
    records = [
        {
            "quantity": quantity,
            "approach": fit.approach,
            "phase": fit.phase,
            "sharing": fit.sharing,
            "fit": fit.kind,
            "cases": found.cases,
            "identified": found.known,
            "median_error_percent": 100.0 * found.quantile(0.5),
            "p95_error_percent": 100.0 * found.quantile(0.95),
            "max_error_percent": 100.0 * found.largest if found.known else float("nan"),
            SHARE: found.share,
        }
        for (fit, quantity), found in sizes.items()
    ]
    return pd.DataFrame.from_records(records)


def summary_markdown(study: Study, summary: pd.DataFrame, paragraph: str, figure: str) -> str:
    """A page to read: what was varied, what it shows, the figure, and the table of errors."""
    lines = [f"# {study.title}", ""]
    lines += [f"{study.cases:,} cases; varied: {', '.join(study.axis_names)}.", ""]
    lines += [paragraph, ""] if paragraph else []
    lines += [f"![{study.title}]({figure})", ""] if figure else []
    lines += grouped_markdown(study, summary) if study.summary_by else _overall_markdown(summary)
    lines += ["", "All numbers: `cases.parquet`; what they are: `manifest.json`.", ""]
    return "\n".join(lines)


def _overall_markdown(summary: pd.DataFrame) -> list[str]:
    lines = [
        "Size of the relative error over all cases in which F_k and c could be identified.",
        "",
        "| quantity | approach | phase | φ, t_s | fit | identified | median | 95 % | largest "
        f"| within {100 * WITHIN:g} % |",
        "|---|---|---|---|---|---:|---:|---:|---:|---:|",
    ]
    for row in summary.to_dict("records"):
        errors = [row[f"{name}_error_percent"] for name in ("median", "p95", "max")]
        cells = [
            *fit_cells(row),
            f"{row['identified']:,}",
            *(percent(0.01 * error) for error in errors),
            percent(row[SHARE]) if row["identified"] else "–",
        ]
        lines.append("| " + " | ".join(cells) + " |")
    return lines
