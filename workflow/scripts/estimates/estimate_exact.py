"""F_k and c from exact features, by every approach."""

from dampbalance.estimates import estimate_table
from dampbalance.features import Features
from dampbalance.project.case import oscillator_from, pairs_from
from dampbalance.project.files import read_csv, write_csv


def main(features_file, oscillator, pairs):
    features = Features.from_frame(read_csv(features_file))
    return estimate_table(features, oscillator_from(oscillator).k, pairs_from(pairs))


if __name__ == "__main__":
    p = snakemake.params
    write_csv(snakemake.output.estimates, main(snakemake.input.features, p.oscillator, p.pairs))
