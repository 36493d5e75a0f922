"""Fixed-step records at one frequency and all levels, stacked in one table by level."""

from dampbalance.project.case import Case
from dampbalance.project.files import write_parquet
from dampbalance.replication import as_published

if __name__ == "__main__":
    case = Case.from_config(snakemake.params.case)
    records = as_published.simulate_levels(case, snakemake.wildcards.frequency)
    write_parquet(snakemake.output.records, as_published.to_frame(records))
