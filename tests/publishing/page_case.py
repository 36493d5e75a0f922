"""The page of the paper's case: what the article is made of, and two small studies."""

from __future__ import annotations

import copy
from pathlib import Path

from dampbalance.figures.style import save_svg
from dampbalance.project.files import read_csv
from dampbalance.publishing.page.report import PageContent, report_page
from dampbalance.replication.numbers import by_key, with_claims
from dampbalance.studies.reading_study import read_study
from dampbalance.studies.shown.paragraph import paragraph
from dampbalance.studies.shown.study_figure import alternative_text, study_figure
from publishing.article_case import RESULTS, STUDIES
from replication.routes import CASE, CONFIG, computed

PAGE = "results/paper/report.html"
COARSER = ("count: 441", "count: 45")  # than in config/studies
FIGURES = ("figure3", "estimation_error", "numerics", "glance")


def results(folder: Path, article: Path) -> PageContent:
    """Everything the page shows, through the files of the pipeline where digits are lost in them.

    folder : for these.   article : that of article_case, in which most of them stand.
    """
    made = article / RESULTS
    claims = read_csv(made / "claims.csv", dtype=str)
    rows = by_key(with_claims(read_csv(made / "numbers.csv"), claims))
    frequency, cases = computed("frequency", folder, COARSER)
    save_svg(study_figure(frequency, cases), folder / "figure.svg", alternative_text(frequency))
    steps = read_study(article / f"{STUDIES}/step_size.yaml")
    text, _ = paragraph(frequency, cases)
    derived = dict(read_csv(made / "derived.csv", dtype=str)[["id", "value"]].to_numpy())
    return PageContent(
        case=CASE,
        config=copy.deepcopy(CONFIG),
        claims=claims,
        numbers=rows,
        figures={name: _text(made / f"figures/{name}.svg") for name in FIGURES},
        derived={**derived, "study.frequency.paragraph": text},
        studies=[
            (frequency, _text(folder / "figure.svg")),
            (steps, _text(article / f"{STUDIES}/step_size/figure.svg")),
        ],
    )


def page_of(made: PageContent) -> str:
    """The page, as it would stand among the results."""
    return report_page(made, PAGE)


def _text(file: Path) -> str:
    return file.read_text(encoding="utf-8")
