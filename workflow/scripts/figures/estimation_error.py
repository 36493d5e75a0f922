"""The error of every estimate against the level of excitation, at each frequency."""

from dampbalance.figures import ALT, estimation_error, save
from dampbalance.project.case import Case
from dampbalance.project.files import read_routes
from dampbalance.project.troubles import brief_troubles

if __name__ == "__main__":
    brief_troubles(snakemake.log)
    case = Case.from_config(snakemake.params.case)
    hertz = case.frequencies_hz
    estimates = read_routes(snakemake.params.folder, "estimates", hertz, ["exact"])["exact"]
    figure = estimation_error(estimates, case.oscillator, hertz, case.levels_m)
    save(figure, snakemake.output.svg, snakemake.output.png, ALT["estimation_error"])
