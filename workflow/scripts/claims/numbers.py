"""Every number of every route in one table: exact, as published with and without its read-outs, and from print."""

from pathlib import Path

from dampbalance.project.case import Case
from dampbalance.project.files import read_csv, read_routes, write_csv
from dampbalance.replication import numbers
from dampbalance.replication.claims import print as paper_print

if __name__ == "__main__":
    p = snakemake.params
    case = Case.from_config(p.case)
    features, estimates = (
        read_routes(p.folder, kind, case.frequencies_hz) for kind in ("features", "estimates")
    )
    routes = {
        route: numbers.of_route(case, features[route], estimates[route]) for route in features
    }
    by_phase = numbers.errors_by_phase(case, features["exact"])
    routes["exact"] = numbers.of_case(case) | routes["exact"] | by_phase
    routes["unrounded"] = {}
    for name, file in zip(case.frequencies_hz, snakemake.input.unrounded, strict=True):
        routes["unrounded"] |= numbers.of_features(name, read_csv(file))
    if p.published:
        printed = paper_print.read_published(Path(p.published))
        routes["from_print"] = paper_print.numbers_from_print(printed, case)
    write_csv(snakemake.output.csv, numbers.numbers_table(routes))
