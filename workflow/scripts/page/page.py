"""The page of a case."""

from pathlib import Path

from dampbalance.motion.orbit import read_orbits
from dampbalance.project.files import read_csv, write_text
from dampbalance.publishing.page.report import PageContent, report_page
from dampbalance.studies.settings import read_study

TABLES = ("table1", "table2", "table3", "statistics")


def read_tables(folder, frequencies):
    """frequency → name → table; the first frequency's files have no suffix."""
    return {
        frequency: {
            name: read_csv(
                f"{folder}/tables/{name}" + (f"_{frequency}" if i else "") + ".csv",
                dtype={"printed": str, "verdict": str},
            )
            for name in TABLES
        }
        for i, frequency in enumerate(frequencies)
    }


def main(config, folder, inputs):
    frequencies = [f["name"] for f in config["excitation"]["frequencies"]]
    studies = [
        read_study(file, "workflow/schemas/study.schema.yaml", "config/config.yaml")
        for file in inputs.study_files
    ]
    return PageContent(
        config=config,
        claims=read_csv(inputs.claims, dtype=str) if inputs.claims else None,
        tables=read_tables(folder, frequencies),
        approaches=read_csv(f"{folder}/tables/approaches.csv"),
        orbits=read_orbits(inputs.orbits),
        estimates={
            name: read_csv(file) for name, file in zip(frequencies, inputs.estimates, strict=True)
        },
        studies=list(zip(studies, map(Path, inputs.study_cases), strict=True)),
    )


if __name__ == "__main__":
    results = main(snakemake.params.config, snakemake.params.folder, snakemake.input)
    page = str(snakemake.output.page)
    write_text(page, report_page(results, page))
