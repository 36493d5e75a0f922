"""The integrals of Table 2 by every scheme and way of rounding, and a in each steady cycle, by rivals as well."""

from dampbalance.project.case import Case
from dampbalance.project.files import write_csv
from dampbalance.project.troubles import brief_troubles
from dampbalance.replication.as_published import scheme_table, trial_table

if __name__ == "__main__":
    brief_troubles(snakemake.log)
    case = Case.from_config(snakemake.params.case)
    frequency = snakemake.params.frequency
    write_csv(snakemake.output.csv, scheme_table(case, frequency))
    write_csv(snakemake.output.cycles, trial_table(case, frequency))
