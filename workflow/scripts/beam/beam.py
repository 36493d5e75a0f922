"""What the stepped-sine tables and the blow say of the bolted beam: page, numbers and figures."""

import sys

from dampbalance.figures.style import save
from dampbalance.identification.measured import configured, identify
from dampbalance.project.files import sha256, write_json, write_text
from dampbalance.project.troubles import brief_troubles
from dampbalance.publishing.rigs import beam_page
from dampbalance.replication.beam import pictures
from dampbalance.replication.beam.findings import findings_of

if __name__ == "__main__":
    brief_troubles(snakemake.log)
    files, beam = snakemake.input, snakemake.params.beam
    try:
        identified = identify(list(files.records), **configured(snakemake.params.measured))
        results = findings_of(identified, beam | {"record": files.blow})
    except ValueError as error:
        sys.exit(f"error: {error}")
    for name, alt in pictures.ALTERNATIVE_TEXTS.items():
        svg, png = snakemake.output[name], snakemake.output[f"{name}_png"]
        save(getattr(pictures, name)(results), svg, png, alt)
    digests = {file.rpartition("/")[2]: sha256(file) for file in (*files.records, files.blow)}
    document = results.document | {"files": digests}
    write_text(snakemake.output.page, beam_page(document, identified.limiting))
    write_json(snakemake.output.numbers, document)
