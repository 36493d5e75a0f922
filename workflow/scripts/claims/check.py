"""Compare the verdicts with those on record; fail with the offending rows when one is worse."""

import sys
from pathlib import Path

from dampbalance.project.files import write_text
from dampbalance.replication.claims import check, read_claims, read_record, summary


def main(claims_file, recorded_file):
    claims = read_claims(Path(claims_file))
    offences = check(claims, read_record(Path(recorded_file)))
    return summary(claims), list(offences["message"])


if __name__ == "__main__":
    text, offences = main(snakemake.input.claims, snakemake.input.recorded)
    if offences:
        heading = f"{len(offences)} printed numbers are worse off than on record ({snakemake.input.recorded}):"
        sys.exit("\n".join([heading, *(f"  {message}" for message in offences)]))
    write_text(snakemake.output.summary, text)
