"""The integrals of Table 2 by every scheme, on rounded and on exact coefficients."""

from dampbalance.article.schemes import scheme_table
from dampbalance.configuration import oscillator_from
from dampbalance.files import write_csv

if __name__ == "__main__":
    p = snakemake.params
    table = scheme_table(oscillator_from(p.oscillator), p.frequency_hz, p.levels_m, p.numerics)
    write_csv(snakemake.output.csv, table)
