"""Which rule and which code made each result, as paths in the repository: what the page links to."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import PurePosixPath


@dataclass(frozen=True, slots=True)
class Origin:
    """Where a result comes from.

    results : its files, {case} standing for the case's folder.   rule : the Snakemake rule.   rules : the file
    that holds it.   code : the modules that do the work.
    """

    what: str
    results: tuple[str, ...]
    rule: str
    rules: str
    code: tuple[str, ...]


def _origin(what: str, chain: str) -> Origin:
    """An origin from "result, below results/ ← file/rule ← modules of the package"."""
    result, rule, code = chain.split(" ← ")
    file, _, name = rule.partition("/")
    modules = tuple(f"src/dampbalance/{module}" for module in code.split())
    return Origin(what, (f"results/{result}",), name, f"workflow/rules/{file}.smk", modules)


ORIGINS = {
    "claims": _origin(
        "Verdicts on the printed numbers",
        "{case}/claims.csv ← claims/claims ← replication/claims/table.py replication/claims/judging.py",
    ),
    "orbits": _origin(
        "Exact steady responses",
        "{case}/orbits ← simulate/simulate_exact ← motion/steady.py motion/one_slip.py",
    ),
    "records": _origin(
        "Fixed-step records, as the paper’s own numbers were computed",
        "{case}/records ← simulate/simulate_as_published ← motion/fixed_step.py",
    ),
    "features": _origin(
        "What is read off the responses",
        "{case}/features ← features/features_exact ← features.py reading/clean.py",
    ),
    "estimates": _origin(
        "F_k and c by every approach",
        "{case}/estimates ← estimates/estimate_exact ← balance.py solver.py",
    ),
    "tables": _origin("Tables", "{case}/tables ← tables/tables ← replication/printed_tables.py"),
    "digits": _origin(
        "How the printed digits arose",
        "{case}/figures/numerics.svg ← article/article_figure ← figures/numerics.py motion/fixed_step.py",
    ),
    "figure3": _origin(
        "Figure 3",
        "{case}/figures/figure3.svg ← figures/figures ← figures/cycle.py motion/orbit.py",
    ),
    "errors": _origin(
        "Estimation error of each approach",
        "{case}/figures/estimation_error.svg ← figures/figures ← figures/error_levels.py solver.py",
    ),
    "studies": _origin(
        "Parameter studies",
        "studies ← studies/study_cases ← studies/evaluate.py studies/responses.py",
    ),
    "page": _origin("This page", "{case}/report.html ← page/page ← publishing/page/report.py"),
}


def study_origin(name: str) -> Origin:
    """The origin of one study: its file says what is varied."""
    files = (f"results/studies/{name}/cases.parquet", f"config/studies/{name}.yaml")
    return replace(ORIGINS["studies"], results=files)


def link(path: str, page: str) -> str:
    """The address of a file of the repository as seen from the page, both as paths from the repository's root."""
    up = len(PurePosixPath(page).parent.parts)
    return "../" * up + path
