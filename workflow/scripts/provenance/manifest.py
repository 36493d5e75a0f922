"""The manifest of the results (configuration, code and packages that made them, with digests), and as an RO-Crate."""

import json
from pathlib import Path

import yaml

from dampbalance.project.files import write_json
from dampbalance.project.troubles import brief_troubles
from dampbalance.publishing.provenance.crate import CrateFolder, crate
from dampbalance.publishing.provenance.manifest import manifest

if __name__ == "__main__":
    brief_troubles(snakemake.log)
    p, o = snakemake.params, snakemake.output
    made = manifest(
        p.case, p.configuration, p.configuration_files, p.sources, p.jobs, p.code, p.lock
    )
    write_json(o.json, made)
    written = json.loads(Path(o.json).read_text(encoding="utf-8"))
    citation = yaml.safe_load(Path(snakemake.input.citation).read_text(encoding="utf-8"))
    write_json(o.crate, crate(written, o.json, citation, CrateFolder(**p.folder)))
