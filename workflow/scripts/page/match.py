"""The picture of the match: which share of each part's printed numbers earns which verdict."""

from dampbalance.project.files import read_csv, write_text
from dampbalance.project.troubles import brief_troubles
from dampbalance.publishing.page.match import match_picture
from dampbalance.replication.claim_verdicts import counts

if __name__ == "__main__":
    brief_troubles(snakemake.log)
    claims = read_csv(snakemake.input.claims, dtype=str)
    write_text(snakemake.output.picture, match_picture(counts(claims)))
