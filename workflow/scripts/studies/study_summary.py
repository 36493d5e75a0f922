"""What a study shows: a table of errors, and a page with the figure and its numbers in words."""

from pathlib import Path

from dampbalance.project.files import STATISTICAL_DIGITS, write_csv, write_text
from dampbalance.project.troubles import brief_troubles
from dampbalance.studies import checking
from dampbalance.studies.shown import facts, summary

if __name__ == "__main__":
    brief_troubles(snakemake.log)
    study = checking.read_study(
        snakemake.input.file, snakemake.params.schema, snakemake.params.base
    )
    table = summary.summary_of(snakemake.input.cases, study)
    figure = next((Path(file).name for file in snakemake.input.figure if file.endswith(".png")), "")
    page = summary.summary_markdown(
        study, table, facts.paragraph(study, snakemake.input.cases), figure
    )
    write_csv(snakemake.output.csv, table, STATISTICAL_DIGITS)
    write_text(snakemake.output.md, page)
