"""The integrals of Table 2 by every scheme, on rounded and on exact coefficients."""

from dampbalance.project.case import oscillator_from
from dampbalance.project.files import write_csv
from dampbalance.replication.schemes import scheme_table

if __name__ == "__main__":
    p = snakemake.params
    table = scheme_table(oscillator_from(p.oscillator), p.frequency_hz, p.levels_m, p.numerics)
    write_csv(snakemake.output.csv, table)
