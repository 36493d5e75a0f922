"""The page of a case."""

from pathlib import Path

import pandas as pd

from dampbalance.figures.numerics import Evidence
from dampbalance.motion.orbit import read_orbits
from dampbalance.project.case import Case
from dampbalance.project.files import read_csv, read_routes, write_text
from dampbalance.project.troubles import brief_troubles
from dampbalance.publishing.page.report import PageContent, report_page
from dampbalance.studies.checking import read_study

TABLES = ("table1", "table2", "table3", "statistics")


def read_tables(folder, case):
    """frequency → name → table."""
    return {
        frequency: {
            name: read_csv(f"{folder}/tables/{name}{case.suffix(frequency)}.csv") for name in TABLES
        }
        for frequency in case.frequencies_hz
    }


def read_evidence(inputs):
    """What the printed digits are told from; None where there are none."""
    if not inputs.claims:
        return None
    return Evidence(
        claims=read_csv(inputs.claims, dtype=str),
        exact=read_csv(inputs.exact),
        estimates=read_csv(inputs.as_published),
        schemes=read_csv(inputs.schemes),
        steps=pd.read_parquet(inputs.steps),
    )


def main(params, inputs):
    config, folder = params.config, params.folder
    case = Case.from_config(config)
    studies = [read_study(file, params.schema, params.base) for file in inputs.study_files]
    return PageContent(
        case=case,
        config=config,
        claims=read_csv(inputs.claims, dtype=str) if inputs.claims else None,
        tables=read_tables(folder, case),
        approaches=read_csv(f"{folder}/tables/approaches.csv"),
        orbits=read_orbits(inputs.orbits),
        estimates=read_routes(folder, "estimates", case.frequencies_hz, ["exact"])["exact"],
        evidence=read_evidence(inputs),
        studies=list(zip(studies, map(Path, inputs.study_cases), strict=True)),
    )


if __name__ == "__main__":
    brief_troubles(snakemake.log)
    results = main(snakemake.params, snakemake.input)
    write_text(snakemake.output.page, report_page(results, snakemake.params.page))
