"""The estimates of all sets of records in one table, a line on each, and the page that compares them."""

from pathlib import Path

from dampbalance.identification.batch import summarise
from dampbalance.project.troubles import brief_troubles

if __name__ == "__main__":
    brief_troubles(snakemake.log)
    at = snakemake.params.at
    summarise(Path(snakemake.output.csv).parent, dict.fromkeys(at, ""), at)
