"""The page of the paper's case, computed in memory, with two small studies."""

from __future__ import annotations

import copy
import json
from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path

import pandas as pd
from matplotlib.figure import Figure

from dampbalance import figures, steady_orbit
from dampbalance.figures import numerics
from dampbalance.figures.numerics import Evidence
from dampbalance.figures.style import save_svg
from dampbalance.project.files import read_csv, write_csv
from dampbalance.publishing.article.derived_numbers import at_a_glance, derived_numbers
from dampbalance.publishing.page.report import PageContent, report_page
from dampbalance.replication.as_published import cycle_table, scheme_table
from dampbalance.replication.claims.changed_digits import packed
from dampbalance.replication.printed_tables import RouteTables, paper_tables
from dampbalance.studies.shown.facts import fact
from dampbalance.studies.shown.study_figure import alternative_text, study_figure
from paper.mutants import sources
from paper.routes import CASE, CONFIG, PAPER, approaches, as_published, computed, exact, judged

CHANGED = ("table1.V_s.4", "table2.b.3", "table2.c.2-3", "table3.V_s.F_k.2-3")
"""The numbers whose digits the page changes; in the workflow it is all of Tables 1 to 3."""
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
    numbers = derived_numbers(
        CASE,
        {route: of.features for route, of in routes.items()},
        {route: of.estimates for route, of in routes.items()},
        claims,
        approaches(),
        (schemes := scheme_table(CASE, "omega1")),
        cycle_table(CASE, "omega1"),
    )
    return PageContent(
        case=CASE,
        config=copy.deepcopy(CONFIG),
        claims=claims,
        tables=made,
        approaches=_through(folder / "approaches.csv", approaches()),
        figures=dict(_figures(folder, claims, routes, schemes, studies[1][1])),
        evidence=json.loads(json.dumps(numbers)),
        facts={
            study.name: {name: fact(study, cases, spec) for name, spec in study.facts.items()}
            for study, cases in studies
        },
        studies=[
            (study, _svg(folder, study_figure(study, cases), alternative_text(study)))
            for study, cases in studies
        ],
        digits=json.loads(json.dumps(packed(sources(), CHANGED))),
    )


def _figures(
    folder: Path,
    claims: pd.DataFrame,
    routes: dict[str, RouteTables],
    schemes: pd.DataFrame,
    steps: Path,
) -> Iterator[tuple[str, str]]:
    """The figures of the page that are not those of studies."""
    evidence = Evidence(
        claims=claims,
        exact=routes["exact"].features["omega1"],
        estimates=routes["as_published"].estimates["omega1"],
        schemes=schemes,
        steps=pd.read_parquet(steps),
    )
    orbits = [steady_orbit(PAPER, motion) for motion in CASE.motions("omega1")]
    errors = (routes["exact"].estimates, PAPER, CASE.frequencies_hz, CASE.levels_m)
    unit = CASE.numerics.tabulated["t_s_unit_s"]
    digits = numerics.numerics(evidence, PAPER, CASE.numerics.step_s, unit)
    found = numerics.glance(*at_a_glance(evidence, approaches(), CASE))
    yield "figure3", _svg(folder, figures.figure3(orbits), figures.ALT["figure3"])
    yield (
        "estimation_error",
        _svg(folder, figures.estimation_error(*errors), figures.ALT["estimation_error"]),
    )
    yield "numerics", _svg(folder, digits, numerics.ALT)
    yield "glance", _svg(folder, found, numerics.GLANCE_ALT)


def _svg(folder: Path, figure: Figure, alt: str) -> str:
    """A figure as its rule writes it."""
    save_svg(figure, folder / "figure.svg", alt)
    return (folder / "figure.svg").read_text(encoding="utf-8")


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
