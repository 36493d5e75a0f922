"""The page of the paper's case, computed in memory, with two small studies."""

from __future__ import annotations

import copy
from functools import lru_cache
from pathlib import Path

import pandas as pd

from dampbalance import steady_orbit
from dampbalance.figures.numerics import Evidence
from dampbalance.project.files import read_csv, write_csv
from dampbalance.publishing.page.report import PageContent, report_page
from dampbalance.replication.printed_tables import paper_tables
from dampbalance.replication.schemes import scheme_table
from paper.routes import CASE, CONFIG, PAPER, approaches, as_published, computed, exact, judged

PAGE = "results/paper/report.html"
# The frequency coarser than in config/studies; of the schemes those without the slowest steps.
COARSER = {
    "frequency": ("count: 441", "count: 45"),
    "step_size": ("[2.0e-6, 5.0e-6, 1.0e-5, 2.0e-5, 4.0e-5, 8.0e-5]", "[5.0e-6, 4.0e-5, 8.0e-5]"),
}


def results(folder: Path) -> PageContent:
    """Everything the page shows, through the files of the pipeline where digits are lost in them."""
    claims = _through(folder / "claims.csv", claims_of_paper(), dtype=str)
    routes = {"exact": exact(PAPER), "as_published": as_published(PAPER)}
    made = {}
    for n, name in enumerate(CASE.frequencies_hz):
        made[name] = {
            table: _through(folder / f"{table}_{name}.csv", frame)
            for table, frame in paper_tables(routes, name, None if n else claims).items()
        }
    studies = [computed(name, folder, coarser) for name, coarser in COARSER.items()]
    evidence = Evidence(
        claims=claims,
        exact=routes["exact"].features["omega1"],
        estimates=routes["as_published"].estimates["omega1"],
        schemes=scheme_table(CASE, "omega1"),
        steps=pd.read_parquet(dict(zip(COARSER, studies, strict=True))["step_size"][1]),
    )
    return PageContent(
        case=CASE,
        config=copy.deepcopy(CONFIG),
        claims=claims,
        tables=made,
        approaches=_through(folder / "approaches.csv", approaches()),
        orbits=[steady_orbit(PAPER, motion) for motion in CASE.motions("omega1")],
        estimates=routes["exact"].estimates,
        evidence=evidence,
        studies=studies,
    )


@lru_cache
def claims_of_paper() -> pd.DataFrame:
    """The table of claims."""
    return judged()


def page_of(made: PageContent) -> str:
    """The page, as it would stand among the results."""
    return report_page(made, PAGE)


def _through(file: Path, frame: pd.DataFrame, dtype: object = None) -> pd.DataFrame:
    """The frame as it comes back from its file."""
    write_csv(file, frame)
    return read_csv(file, dtype)
