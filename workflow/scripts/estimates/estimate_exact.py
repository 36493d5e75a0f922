"""F_k and c from exact features, by every approach."""

from dampbalance.estimates import estimate_table
from dampbalance.features import Features
from dampbalance.project.case import Case
from dampbalance.project.files import read_csv, write_csv

if __name__ == "__main__":
    case, files = Case.from_config(snakemake.params.case), snakemake.input.features
    for file, output in zip(files, snakemake.output.estimates, strict=True):
        features = Features.from_frame(read_csv(file))
        write_csv(output, estimate_table(features, case.oscillator.k, case.pairs))
