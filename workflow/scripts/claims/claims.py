"""A verdict on every printed number, as CSV and Markdown."""

from dampbalance.project.case import Case
from dampbalance.project.files import write_csv, write_text
from dampbalance.replication.claims.rules import read_sources
from dampbalance.replication.claims.table import claims_markdown, claims_table

if __name__ == "__main__":
    p = snakemake.params
    table = claims_table(read_sources(p.folder, p.published, Case.from_config(p.case)))
    write_csv(snakemake.output.csv, table)
    write_text(snakemake.output.md, claims_markdown(table))
