"""The site of documentation."""

from dampbalance.project.troubles import brief_troubles
from dampbalance.publishing.site import build_site

if __name__ == "__main__":
    brief_troubles(snakemake.log)
    build_site(".", snakemake.output.site)
