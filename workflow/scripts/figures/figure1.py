"""Figure 1: the oscillator and its contact."""

from dampbalance.figures import ALT, save, schematic
from dampbalance.project.troubles import brief_troubles

if __name__ == "__main__":
    brief_troubles(snakemake.log)
    save(schematic(), snakemake.output.svg, snakemake.output.png, ALT["figure1"])
