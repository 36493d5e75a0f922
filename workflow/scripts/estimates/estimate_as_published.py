"""F_k and c from the read-outs of the as-published route, its Table 3 with the sign that the printed columns have."""

from dampbalance.balance import APPROACHES_OF_TABLE_3
from dampbalance.estimates import estimate_table
from dampbalance.features import Features
from dampbalance.project.case import oscillator_from, pairs_from
from dampbalance.project.files import read_csv, write_csv


def main(tabulated_file, two_point_file, oscillator, pairs):
    tabulated, two_point = (
        Features.from_frame(read_csv(file)) for file in (tabulated_file, two_point_file)
    )
    return estimate_table(
        tabulated,
        oscillator_from(oscillator).k,
        pairs_from(pairs),
        common=two_point,
        common_approaches=APPROACHES_OF_TABLE_3,
    )


if __name__ == "__main__":
    p = snakemake.params
    table = main(snakemake.input.tabulated, snakemake.input.two_point, p.oscillator, p.pairs)
    write_csv(snakemake.output.estimates, table)
