"""A verdict on every printed number, as CSV and Markdown."""

from pathlib import Path

from dampbalance.project.case import Case
from dampbalance.project.files import ROUTES, read_csv, read_routes, write_csv, write_text
from dampbalance.project.troubles import brief_troubles
from dampbalance.replication.claims import (
    RouteTables,
    claims_markdown,
    claims_table,
    read_published,
)

if __name__ == "__main__":
    brief_troubles(snakemake.log)
    p = snakemake.params
    case = Case.from_config(p.case)
    features, estimates = (
        read_routes(p.folder, kind, case.frequencies_hz) for kind in ("features", "estimates")
    )
    exact, as_published = (RouteTables(features[route], estimates[route]) for route in ROUTES)
    unrounded = read_csv(snakemake.input.unrounded)
    table = claims_table(read_published(Path(p.published)), case, exact, as_published, unrounded)
    write_csv(snakemake.output.csv, table)
    write_text(snakemake.output.md, claims_markdown(table))
