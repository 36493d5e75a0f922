"""The page of a case."""

import json
from pathlib import Path

from dampbalance.project.case import Case
from dampbalance.project.files import read_csv, write_text
from dampbalance.publishing.page.report import PageContent, report_page
from dampbalance.replication.numbers import by_key, with_claims
from dampbalance.replication.rebuilt_tables import paper_tables
from dampbalance.studies.reading_study import read_study


def read_text(file):
    return Path(file).read_text(encoding="utf-8")


def main(params, inputs):
    config = params.config
    case = Case.from_config(config)
    studies = list(map(read_study, inputs.study_files, params.papers))
    claims = read_csv(inputs.claims, dtype=str) if inputs.claims else None
    table = read_csv(inputs.numbers)
    numbers = by_key(table if claims is None else with_claims(table, claims))
    return PageContent(
        case=case,
        config=config,
        claims=claims,
        tables={name: paper_tables(numbers, name) for name in case.frequencies_hz},
        approaches=read_csv(inputs.approaches),
        figures=dict(zip(params.figures, map(read_text, inputs.figures), strict=True)),
        evidence=json.loads(read_text(inputs.evidence)) if inputs.evidence else None,
        shown=json.loads(read_text(inputs.shown)) if inputs.shown else {},
        studies=list(zip(studies, map(read_text, inputs.study_figures), strict=True)),
        study_folder=params.study_folder,
    )


if __name__ == "__main__":
    results = main(snakemake.params, snakemake.input)
    write_text(snakemake.output.page, report_page(results, snakemake.params.page))
