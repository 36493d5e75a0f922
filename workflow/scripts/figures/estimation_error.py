"""The error of every estimate against the level of excitation, at each frequency."""

from dampbalance.figures import ALT, estimation_error, save
from dampbalance.project.case import oscillator_from
from dampbalance.project.files import read_csv


def main(estimates_files, oscillator, frequencies_hz, levels_m):
    estimates = {
        name: read_csv(file) for name, file in zip(frequencies_hz, estimates_files, strict=True)
    }
    return estimation_error(estimates, oscillator_from(oscillator), frequencies_hz, levels_m)


if __name__ == "__main__":
    p = snakemake.params
    figure = main(snakemake.input.estimates, p.oscillator, p.frequencies_hz, p.levels_m)
    save(figure, snakemake.output.svg, snakemake.output.png, ALT["estimation_error"])
