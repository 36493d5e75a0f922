"""Numbers that the article argues with, computed from the other results."""

from dampbalance.project.case import oscillator_from, pairs_from
from dampbalance.project.files import read_csv, write_json
from dampbalance.publishing.article.evidence import evidence


def read_routes(folder, kind, routes, frequencies):
    return {
        route: {name: read_csv(f"{folder}/{kind}/{route}/{name}.csv") for name in frequencies}
        for route in routes
    }


if __name__ == "__main__":
    p = snakemake.params
    features, estimates = (
        read_routes(p.folder, kind, p.routes, p.frequencies_hz)
        for kind in ("features", "estimates")
    )
    found = evidence(
        oscillator_from(p.oscillator),
        features,
        estimates,
        claims=read_csv(snakemake.input.claims, dtype=str),
        approaches=read_csv(snakemake.input.approaches),
        schemes=read_csv(snakemake.input.schemes),
        pairs=pairs_from(p.pairs),
        numerics=p.numerics,
        frequencies_hz=p.frequencies_hz,
    )
    write_json(snakemake.output.json, found)
