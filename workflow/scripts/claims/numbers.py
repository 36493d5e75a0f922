"""Every number of every route in one table: exact, as published, before it is read, and from print."""

from pathlib import Path

from dampbalance.project.case import Case
from dampbalance.project.files import EVERY_DIGIT, read_csv, read_routes, write_csv
from dampbalance.replication import numbers
from dampbalance.replication.claims import printed

if __name__ == "__main__":
    p = snakemake.params
    case = Case.from_config(p.case)
    features, estimates = (
        read_routes(p.folder, kind, case.frequencies_hz) for kind in ("features", "estimates")
    )
    unrounded = map(read_csv, snakemake.input.unrounded)
    features["unrounded"] = dict(zip(case.frequencies_hz, unrounded, strict=True))
    routes, ids = numbers.of_routes(case, features, estimates), {}
    if p.published:
        published = printed.read_published(Path(p.published))
        routes["from_print"] = printed.from_print(published, case)
        ids = published.ids
    write_csv(snakemake.output.csv, numbers.numbers_table(routes, ids), EVERY_DIGIT)
