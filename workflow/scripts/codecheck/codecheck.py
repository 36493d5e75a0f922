"""The report for a CODECHECK: what the outputs of codecheck.yml are, and how the printed numbers fare."""

from pathlib import Path

from dampbalance import __version__
from dampbalance.project.files import write_text
from dampbalance.project.troubles import brief_troubles
from dampbalance.publishing.codecheck import read, report
from dampbalance.replication.claims import read_claims

if __name__ == "__main__":
    brief_troubles()
    paths, output = snakemake.input, snakemake.output.report
    configuration = read(paths.configuration, paths.schema)
    claims = read_claims(Path(paths.claims))
    text = report(configuration, claims, __version__, output, snakemake.params.top)
    write_text(output, text)
