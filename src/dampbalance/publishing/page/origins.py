"""Which rule and which code made each result, as paths in the repository: what the page links to."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import PurePosixPath


@dataclass(frozen=True, slots=True)
class Origin:
    """Where a result comes from.

    result : its files, {case} standing for the case's folder.   rule : the Snakemake rule.   rules : the file
    that holds it.   code : the modules that do the work.
    """

    what: str
    results: tuple[str, ...]
    rule: str
    rules: str
    code: tuple[str, ...]


_PACKAGE = "src/dampbalance"

ORIGINS = {
    "claims": Origin(
        "Verdicts on the printed numbers",
        ("results/{case}/claims.csv",),
        "claims",
        "workflow/rules/claims.smk",
        (f"{_PACKAGE}/replication/claims/table.py", f"{_PACKAGE}/replication/claims/judging.py"),
    ),
    "orbits": Origin(
        "Exact steady responses",
        ("results/{case}/orbits",),
        "simulate_exact",
        "workflow/rules/simulate.smk",
        (f"{_PACKAGE}/motion/steady.py", f"{_PACKAGE}/motion/one_slip.py"),
    ),
    "records": Origin(
        "Fixed-step records, as the paper’s own numbers were computed",
        ("results/{case}/records",),
        "simulate_as_published",
        "workflow/rules/simulate.smk",
        (f"{_PACKAGE}/motion/fixed_step.py",),
    ),
    "features": Origin(
        "What is read off the responses",
        ("results/{case}/features",),
        "features_exact",
        "workflow/rules/features.smk",
        (f"{_PACKAGE}/features.py", f"{_PACKAGE}/reading/clean.py"),
    ),
    "estimates": Origin(
        "F_k and c by every approach",
        ("results/{case}/estimates",),
        "estimate_exact",
        "workflow/rules/estimates.smk",
        (f"{_PACKAGE}/balance.py", f"{_PACKAGE}/solver.py"),
    ),
    "tables": Origin(
        "Tables",
        ("results/{case}/tables",),
        "tables",
        "workflow/rules/tables.smk",
        (f"{_PACKAGE}/replication/tables.py",),
    ),
    "figure3": Origin(
        "Figure 3",
        ("results/{case}/figures/figure3.svg",),
        "figure3",
        "workflow/rules/figures.smk",
        (f"{_PACKAGE}/figures/acceleration.py", f"{_PACKAGE}/motion/orbit.py"),
    ),
    "errors": Origin(
        "Estimation error of each approach",
        ("results/{case}/figures/estimation_error.svg",),
        "estimation_error",
        "workflow/rules/figures.smk",
        (f"{_PACKAGE}/figures/error_levels.py", f"{_PACKAGE}/solver.py"),
    ),
    "studies": Origin(
        "Parameter studies",
        ("results/studies",),
        "study_cases",
        "workflow/rules/studies.smk",
        (f"{_PACKAGE}/studies/evaluate.py", f"{_PACKAGE}/studies/responses.py"),
    ),
    "page": Origin(
        "This page",
        ("results/{case}/report.html",),
        "page",
        "workflow/rules/page.smk",
        (f"{_PACKAGE}/publishing/page/report.py",),
    ),
}


def study_origin(name: str) -> Origin:
    """The origin of one study: its file says what is varied."""
    general = ORIGINS["studies"]
    return Origin(
        general.what,
        (f"results/studies/{name}/cases.parquet", f"config/studies/{name}.yaml"),
        general.rule,
        general.rules,
        general.code,
    )


def link(path: str, page: str) -> str:
    """The address of a file of the repository as seen from the page, both as paths from the repository's root."""
    up = len(PurePosixPath(page).parent.parts)
    return "../" * up + path
