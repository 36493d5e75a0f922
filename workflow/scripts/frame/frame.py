"""What the records of the frame say: page, numbers and figures."""

import json
import sys
from pathlib import Path

from dampbalance.figures.style import save
from dampbalance.project.files import write_json, write_text
from dampbalance.project.troubles import brief_troubles
from dampbalance.publishing.rigs import frame_page
from dampbalance.replication.frame import pictures
from dampbalance.replication.frame.findings import findings

if __name__ == "__main__":
    brief_troubles(snakemake.log)
    files, measured = snakemake.input, snakemake.params.measured
    identified = json.loads(Path(files.identification).read_text(encoding="utf-8"))
    try:
        results = findings(list(files.records), measured, snakemake.params.frame, identified)
    except ValueError as error:
        sys.exit(f"error: {error}")
    for name, alt in pictures.ALTERNATIVE_TEXTS.items():
        svg, png = snakemake.output[name], snakemake.output[f"{name}_png"]
        save(getattr(pictures, name)(results), svg, png, alt)
    limits = [limit["words"] for limit in identified["limits"]]
    write_text(snakemake.output.page, frame_page(results.document, measured, limits))
    write_json(snakemake.output.numbers, results.document)
