"""Sources, results, digests and a README in one file."""

from dampbalance.project.documents import read_yaml
from dampbalance.project.troubles import brief_troubles
from dampbalance.publishing.provenance.archive import pack

if __name__ == "__main__":
    brief_troubles(snakemake.log)
    p = snakemake.params
    pack(
        snakemake.output.archive,
        p.sources,
        snakemake.input.manifest,
        read_yaml(p.citation),
        p.rebuild,
    )
