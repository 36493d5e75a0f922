"""F_k and c from exact features, by every approach."""

from dampbalance.configuration import oscillator_from, pairs_from
from dampbalance.features import Features
from dampbalance.files import read_csv, write_csv
from dampbalance.identify import estimate_table


def main(features_file, oscillator, pairs):
    features = Features.from_frame(read_csv(features_file))
    return estimate_table(features, oscillator_from(oscillator).k, pairs_from(pairs))


if __name__ == "__main__":
    p = snakemake.params
    write_csv(snakemake.output.estimates, main(snakemake.input.features, p.oscillator, p.pairs))
