"""A verdict on every printed number, as CSV and Markdown."""

from pathlib import Path

from dampbalance.project.case import Case
from dampbalance.project.files import read_csv, write_csv, write_text
from dampbalance.replication.claims.causes import Sources
from dampbalance.replication.claims.printed import read_published
from dampbalance.replication.claims.table import claims_markdown, claims_table
from dampbalance.replication.numbers import by_key

if __name__ == "__main__":
    p, numbers = snakemake.params, by_key(read_csv(snakemake.input.numbers))
    printed = read_published(Path(p.published))
    table = claims_table(Sources(printed, Case.from_config(p.case), numbers))
    write_csv(snakemake.output.csv, table)
    write_text(snakemake.output.md, claims_markdown(table))
