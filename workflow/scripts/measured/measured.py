"""The estimates of all sets of records in one table."""

import pandas as pd

from dampbalance.project.files import read_csv, write_csv
from dampbalance.project.troubles import brief_troubles

if __name__ == "__main__":
    brief_troubles(snakemake.log)
    parts = []
    for name, file in zip(snakemake.params.names, snakemake.input.sets, strict=True):
        part = read_csv(file)
        part.insert(0, "set", name)
        parts.append(part)
    write_csv(snakemake.output.csv, pd.concat(parts, ignore_index=True))
