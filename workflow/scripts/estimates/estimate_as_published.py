"""F_k and c from the read-outs of the as-published route, its Table 3 with the sign that the printed columns have."""

from dampbalance.features import Features
from dampbalance.project.case import Case
from dampbalance.project.files import read_csv, write_csv
from dampbalance.replication import authors_route

if __name__ == "__main__":
    case, files = Case.from_config(snakemake.params.case), snakemake.input
    for *read, output in zip(
        files.tabulated, files.two_point, snakemake.output.estimates, strict=True
    ):
        tabulated, two_point = (Features.from_frame(read_csv(file)) for file in read)
        write_csv(output, authors_route.estimates(tabulated, two_point, case))
