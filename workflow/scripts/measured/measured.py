"""The estimates of all sets of records in one table, and a line on each as text."""

from pathlib import Path

from dampbalance.identification.table_of_sets import summarise

if __name__ == "__main__":
    folder = Path(snakemake.output.csv).parent
    print(summarise(folder, dict.fromkeys(snakemake.params.sets, "")))
