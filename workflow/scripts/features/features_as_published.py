"""Features read off fixed-step records: as tabulated, as they entered the two-point formulas, and in full digits."""

import pandas as pd

from dampbalance.project.case import Case
from dampbalance.project.files import READ_OUT_DIGITS, write_csv
from dampbalance.replication import authors_route
from dampbalance.replication.record import Record

if __name__ == "__main__":
    case, output = Case.from_config(snakemake.params.case), snakemake.output
    for i, (frequency, file) in enumerate(
        zip(case.frequencies_hz, snakemake.input.records, strict=True)
    ):
        levels = pd.read_parquet(file).groupby("level")
        records = [Record.from_frame(frame.drop(columns="level")) for _, frame in levels]
        read = authors_route.read_levels(records, case, frequency)
        write_csv(output.tabulated[i], read.tabulated.to_frame(), READ_OUT_DIGITS)
        write_csv(output.two_point[i], read.two_point.to_frame(), READ_OUT_DIGITS)
        write_csv(output.unrounded[i], read.to_frame(), READ_OUT_DIGITS)
