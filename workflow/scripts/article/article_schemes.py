"""The integrals of Table 2 by every scheme, on rounded and on exact coefficients, and a in each steady cycle."""

from dampbalance.project.case import Case
from dampbalance.project.files import write_csv
from dampbalance.project.troubles import brief_troubles
from dampbalance.replication.as_published import cycle_table, scheme_table

if __name__ == "__main__":
    brief_troubles(snakemake.log)
    case = Case.from_config(snakemake.params.case)
    frequency = snakemake.params.frequency
    write_csv(snakemake.output.csv, scheme_table(case, frequency))
    write_csv(snakemake.output.cycles, cycle_table(case, frequency))
