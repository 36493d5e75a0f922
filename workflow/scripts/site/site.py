"""The site of documentation."""

from dampbalance.project.troubles import brief_troubles
from dampbalance.publishing.site import build

if __name__ == "__main__":
    brief_troubles(snakemake.log)
    build(".", snakemake.output.site)
