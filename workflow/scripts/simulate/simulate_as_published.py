"""Fixed-step records at one frequency and all levels, stacked in one table by level."""

import pandas as pd

from dampbalance.project.case import Case
from dampbalance.project.files import write_parquet
from dampbalance.project.troubles import brief_troubles
from dampbalance.replication import as_published

if __name__ == "__main__":
    brief_troubles(snakemake.log)
    case = Case.from_config(snakemake.params.case)
    records = as_published.simulate_levels(case, snakemake.wildcards.frequency)
    frames = [record.to_frame().assign(level=i) for i, record in enumerate(records, start=1)]
    write_parquet(snakemake.output.records, pd.concat(frames, ignore_index=True))
