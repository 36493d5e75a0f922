"""Features read off fixed-step records: as tabulated, and as they entered the two-point formulas."""

import math

import pandas as pd

from dampbalance.features import stack
from dampbalance.project.case import oscillator_from
from dampbalance.project.files import write_csv
from dampbalance.reading.clean import of_record
from dampbalance.record import Record
from dampbalance.replication.readout import ReadOut


def main(records_file, oscillator, frequency_hz, numerics, phase):
    omega, k = 2.0 * math.pi * frequency_hz, oscillator_from(oscillator).k
    frames = pd.read_parquet(records_file).groupby("level")
    records = [Record.from_frame(frame.drop(columns="level")) for _, frame in frames]
    between = stack([of_record(record, omega, k, "interpolated") for record in records])
    between = between.with_phase(phase)
    sampled = stack([of_record(record, omega, k, "sample") for record in records])
    integrals = {name: getattr(sampled, name) for name in ("a", "b", "W")}
    tabulated = ReadOut.from_config(numerics["tabulated"]).apply(between).replaced(**integrals)
    two_point = ReadOut.from_config(numerics["two_point"]).common(between).replaced(**integrals)
    return tabulated.to_frame(), two_point.to_frame()


if __name__ == "__main__":
    p = snakemake.params
    tables = main(snakemake.input.records, p.oscillator, p.frequency_hz, p.numerics, p.phase)
    for path, table in zip(snakemake.output, tables, strict=True):
        write_csv(path, table)
