"""The report for a CODECHECK: what the outputs of codecheck.yml are, and how the printed numbers fare."""

from dampbalance import __version__
from dampbalance.project.files import read_csv, write_text
from dampbalance.project.troubles import brief_troubles
from dampbalance.publishing.codecheck import read, report

if __name__ == "__main__":
    brief_troubles(snakemake.log)
    paths, output = snakemake.input, snakemake.output.report
    configuration = read(paths.configuration, paths.schema)
    claims = read_csv(paths.claims, dtype=str)
    text = report(configuration, claims, __version__, output, snakemake.params.top)
    write_text(output, text)
