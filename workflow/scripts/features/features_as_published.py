"""Features read off fixed-step records: as tabulated, and as they entered the two-point formulas."""

import pandas as pd

from dampbalance.project.case import Case
from dampbalance.project.files import write_csv
from dampbalance.replication import as_published

if __name__ == "__main__":
    case = Case.from_config(snakemake.params.case)
    records = as_published.from_frame(pd.read_parquet(snakemake.input.records))
    read = as_published.read_levels(records, case, snakemake.wildcards.frequency)
    write_csv(snakemake.output.tabulated, read.tabulated.to_frame())
    write_csv(snakemake.output.two_point, read.two_point.to_frame())
