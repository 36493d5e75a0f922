"""The manifest of the results: configuration, code and packages that made them, with digests."""

from dampbalance.project.files import write_json
from dampbalance.publishing.provenance.manifest import manifest

if __name__ == "__main__":
    p = snakemake.params
    document = manifest(
        p.case, p.configuration, p.configuration_files, p.sources, p.jobs, p.code, p.lock
    )
    write_json(snakemake.output.json, document)
