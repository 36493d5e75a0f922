"""Compare the verdicts with those on record: a summary, which begins and ends with those that are worse."""

from pathlib import Path

from dampbalance.project.files import write_text
from dampbalance.replication.claims.printed import read_texts
from dampbalance.replication.claims.table import CLAIM_COLUMNS, check_claims, read_record, summary

if __name__ == "__main__":
    claims = read_texts(Path(snakemake.input.claims), CLAIM_COLUMNS)
    offences = check_claims(claims, read_record(Path(snakemake.input.recorded)))
    write_text(snakemake.output.summary, summary(claims, offences))
