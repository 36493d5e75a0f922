"""F_k and c by every approach from exact features, or from the read-outs of the as-published route, its Table 3 with
the sign that the printed columns have."""

from dampbalance.estimates import estimate_table
from dampbalance.features import Features
from dampbalance.project.case import Case
from dampbalance.project.files import read_csv, write_csv
from dampbalance.replication import authors_route

if __name__ == "__main__":
    case, files = Case.from_config(snakemake.params.case), snakemake.input
    for i, output in enumerate(snakemake.output.estimates):
        features = Features.from_frame(read_csv(files.features[i]))
        if files.two_point:
            two_point = Features.from_frame(read_csv(files.two_point[i]))
            write_csv(output, authors_route.estimates(features, two_point, case))
        else:
            write_csv(output, estimate_table(features, case.oscillator.k, case.pairs))
