"""Features read off fixed-step records: as tabulated, as they entered the two-point formulas, and in full digits."""

import pandas as pd

from dampbalance.project.case import Case
from dampbalance.project.files import write_csv
from dampbalance.project.troubles import brief_troubles
from dampbalance.record import Record
from dampbalance.replication import as_published

if __name__ == "__main__":
    brief_troubles()
    case = Case.from_config(snakemake.params.case)
    levels = pd.read_parquet(snakemake.input.records).groupby("level")
    records = [Record.from_frame(frame.drop(columns="level")) for _, frame in levels]
    read = as_published.read_levels(records, case, snakemake.wildcards.frequency)
    write_csv(snakemake.output.tabulated, read.tabulated.to_frame())
    write_csv(snakemake.output.two_point, read.two_point.to_frame())
    write_csv(snakemake.output.unrounded, read.unrounded.to_frame())
