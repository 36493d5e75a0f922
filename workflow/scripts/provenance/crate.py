"""The manifest as an RO-Crate of the case's results."""

import json
from pathlib import Path

import yaml

from dampbalance.project.files import write_json
from dampbalance.project.troubles import brief_troubles
from dampbalance.publishing.provenance.crate import CrateFolder, crate

if __name__ == "__main__":
    brief_troubles(snakemake.log)
    manifest = json.loads(Path(snakemake.input.manifest).read_text(encoding="utf-8"))
    citation = yaml.safe_load(Path(snakemake.input.citation).read_text(encoding="utf-8"))
    p = snakemake.params
    write_json(
        snakemake.output.json, crate(manifest, p.manifest_name, citation, CrateFolder(**p.folder))
    )
