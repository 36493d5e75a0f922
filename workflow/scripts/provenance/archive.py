"""Sources, results, digests and a README in one file."""

import json
from pathlib import Path

import yaml

from dampbalance.project.troubles import brief_troubles
from dampbalance.publishing.provenance.archive import pack

if __name__ == "__main__":
    brief_troubles(snakemake.log)
    file, p = snakemake.input.manifest, snakemake.params
    manifest = json.loads(Path(file).read_text(encoding="utf-8"))
    citation = yaml.safe_load(Path(p.citation).read_text(encoding="utf-8"))
    pack(
        snakemake.output.archive,
        p.sources,
        manifest,
        file,
        snakemake.input.crate,
        citation,
        p.rebuild,
    )
