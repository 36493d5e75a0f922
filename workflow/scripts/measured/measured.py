"""The estimates of all sets of records in one table, and a line on each."""

from pathlib import Path

from dampbalance.identification.batch import summarise
from dampbalance.project.troubles import brief_troubles

if __name__ == "__main__":
    brief_troubles(snakemake.log)
    summarise(Path(snakemake.output.csv).parent, dict.fromkeys(snakemake.params.names, ""))
