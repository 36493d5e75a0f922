"""The verdicts that change where a digit of a printed table does, as JSON."""

import json

from dampbalance.project.case import Case
from dampbalance.project.files import write_text
from dampbalance.project.troubles import brief_troubles
from dampbalance.replication.claims.changed_digits import cells, packed
from dampbalance.replication.claims.rules import read_sources

if __name__ == "__main__":
    brief_troubles(snakemake.log)
    p = snakemake.params
    sources = read_sources(p.folder, p.published, Case.from_config(p.case))
    text = json.dumps(packed(sources, cells(sources)), ensure_ascii=False, separators=(",", ":"))
    write_text(snakemake.output.json, f"{text}\n")
