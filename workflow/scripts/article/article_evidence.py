"""Numbers that the article argues with, computed from the other results."""

from dampbalance.project.case import Case
from dampbalance.project.files import read_csv, read_routes, write_json
from dampbalance.project.troubles import brief_troubles
from dampbalance.publishing.article.derived_numbers import derived_numbers

if __name__ == "__main__":
    brief_troubles(snakemake.log)
    i, folder = snakemake.input, snakemake.params.folder
    case = Case.from_config(snakemake.params.case)
    numbers = derived_numbers(
        case,
        features=read_routes(folder, "features", case.frequencies_hz),
        estimates=read_routes(folder, "estimates", case.frequencies_hz),
        claims=read_csv(i.claims, dtype=str),
        approaches=read_csv(i.approaches),
        schemes=read_csv(i.schemes),
        cycles=read_csv(i.cycles),
    )
    write_json(snakemake.output.json, numbers)
