"""The page of a case."""

import json
from pathlib import Path

from dampbalance.project.case import Case
from dampbalance.project.files import read_csv, write_text
from dampbalance.publishing.page.report import PageContent, report_page
from dampbalance.studies.reading_study import read_study

TABLES = ("table1", "table2", "table3", "statistics")


def read_tables(folder, case):
    """Return frequency → name → table."""
    return {
        frequency: {
            name: read_csv(f"{folder}/tables/{name}{case.suffix(frequency)}.csv") for name in TABLES
        }
        for frequency in case.frequencies_hz
    }


def read_text(file):
    return Path(file).read_text(encoding="utf-8")


def main(params, inputs):
    config, folder = params.config, params.folder
    case = Case.from_config(config)
    studies = list(map(read_study, inputs.study_files, params.papers))
    claims = read_csv(inputs.claims, dtype=str) if inputs.claims else None
    return PageContent(
        case=case,
        config=config,
        claims=claims,
        tables=read_tables(folder, case),
        approaches=read_csv(f"{folder}/tables/approaches.csv"),
        figures=dict(zip(params.figures, map(read_text, inputs.figures), strict=True)),
        evidence=json.loads(read_text(inputs.evidence)) if inputs.evidence else None,
        shown=json.loads(read_text(inputs.shown)) if inputs.shown else {},
        studies=list(zip(studies, map(read_text, inputs.study_figures), strict=True)),
        study_folder=params.study_folder,
    )


if __name__ == "__main__":
    results = main(snakemake.params, snakemake.input)
    write_text(snakemake.output.page, report_page(results, snakemake.params.page))
