"""The paper's tables at each frequency, and every approach at every frequency, as CSV and Markdown."""

from dampbalance.project.case import Case
from dampbalance.project.files import read_csv, write_csv, write_text
from dampbalance.replication.comparison import approaches_markdown, approaches_table
from dampbalance.replication.numbers import by_key, with_claims
from dampbalance.replication.rebuilt_tables import COLUMNS, TITLES, markdown, paper_tables

if __name__ == "__main__":
    claims, folder = snakemake.input.claims, snakemake.params.folder
    case, table = Case.from_config(snakemake.params.case), read_csv(snakemake.input.numbers)
    numbers = by_key(with_claims(table, read_csv(claims)) if claims else table)
    for frequency, hz in case.frequencies_hz.items():
        for name, cells in paper_tables(numbers, frequency).items():
            path = f"{folder}/tables/{name}{case.suffix(frequency)}"
            write_csv(f"{path}.csv", cells[list(COLUMNS)])
            write_text(f"{path}.md", markdown(cells, f"{TITLES[name]}, {hz:g} Hz"))
    everywhere = approaches_table(numbers, case.frequencies_hz)
    path = f"{folder}/tables/approaches"
    write_csv(f"{path}.csv", everywhere)
    write_text(f"{path}.md", approaches_markdown(everywhere, TITLES["approaches"]))
