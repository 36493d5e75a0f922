"""Figures 1–3, the error of every estimate against the level of excitation, and the picture of the match."""

from dampbalance.figures import ALT
from dampbalance.figures.cycle import figure3, friction_velocity_loop
from dampbalance.figures.error_levels import estimation_error
from dampbalance.figures.schematic import schematic
from dampbalance.figures.style import save, save_svg
from dampbalance.motion.orbit import read_orbits
from dampbalance.project.case import Case
from dampbalance.project.files import read_csv, read_routes
from dampbalance.publishing.match import match_figure, match_words
from dampbalance.replication.claims.verdicts import counts

if __name__ == "__main__":
    orbits, output = read_orbits(snakemake.input.orbits), snakemake.output
    case = Case.from_config(snakemake.params.case)
    hertz = case.frequencies_hz
    estimates = read_routes(snakemake.params.folder, "estimates", hertz, ["exact"])["exact"]
    drawn = {
        "figure1": schematic(),
        "figure2": friction_velocity_loop(orbits[0]),
        "figure3": figure3(orbits),
        "estimation_error": estimation_error(estimates, case.oscillator, hertz, case.levels_m),
    }
    for name, figure in drawn.items():
        svg, png = (getattr(output, f"{name}_{kind}") for kind in ("svg", "png"))
        save(figure, svg, png, ALT[name])
    if snakemake.input.claims:
        claims = read_csv(snakemake.input.claims, dtype=str)
        counted = counts(claims)
        save_svg(match_figure(counted), output.match, match_words(counted))
