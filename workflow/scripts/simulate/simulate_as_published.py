"""Fixed-step records at all levels, stacked by level in a table for each frequency."""

import pandas as pd

from dampbalance.project.case import Case
from dampbalance.project.files import write_parquet
from dampbalance.replication import authors_route

if __name__ == "__main__":
    case = Case.from_config(snakemake.params.case)
    for frequency, file in zip(case.frequencies_hz, snakemake.output.records, strict=True):
        records = authors_route.simulate_levels(case, frequency)
        frames = [record.to_frame().assign(level=i) for i, record in enumerate(records, start=1)]
        write_parquet(file, pd.concat(frames, ignore_index=True))
