"""Figure 3: acceleration against displacement and velocity, at all levels."""

from dampbalance.figures import ALT, figure3, save
from dampbalance.motion.orbit import read_orbits
from dampbalance.project.troubles import brief_troubles

if __name__ == "__main__":
    brief_troubles(snakemake.log)
    figure = figure3(read_orbits(snakemake.input.orbits))
    save(figure, snakemake.output.svg, snakemake.output.png, ALT["figure3"])
