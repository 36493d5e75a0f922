"""Fixed-step records at all levels, stacked by level, and the features read off them: as tabulated, as they entered the
two-point formulas, and in full digits. Files for each frequency."""

import pandas as pd

from dampbalance.project.case import Case
from dampbalance.project.files import READ_OUT_DIGITS, write_csv, write_parquet
from dampbalance.replication import authors_route

if __name__ == "__main__":
    case, output = Case.from_config(snakemake.params.case), snakemake.output
    for i, frequency in enumerate(case.frequencies_hz):
        records = authors_route.simulate_levels(case, frequency)
        frames = [record.to_frame().assign(level=n) for n, record in enumerate(records, start=1)]
        write_parquet(output.records[i], pd.concat(frames, ignore_index=True))
        read = authors_route.read_levels(records, case, frequency)
        write_csv(output.tabulated[i], read.tabulated.to_frame(), READ_OUT_DIGITS)
        write_csv(output.two_point[i], read.two_point.to_frame(), READ_OUT_DIGITS)
        write_csv(output.unrounded[i], read.to_frame(), READ_OUT_DIGITS)
