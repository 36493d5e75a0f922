"""The site of documentation."""

from dampbalance.publishing.site import build_site

if __name__ == "__main__":
    build_site(".", snakemake.output.site)
