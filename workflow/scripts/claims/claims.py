"""A verdict on every printed number, as CSV and Markdown."""

from pathlib import Path

from dampbalance.project.case import oscillator_from
from dampbalance.project.files import read_csv, write_csv, write_text
from dampbalance.replication.claims import (
    RouteTables,
    Setting,
    claims_markdown,
    claims_table,
    read_published,
)


def read_route(results, route, frequencies):
    features, estimates = (
        {name: read_csv(f"{results}/{kind}/{route}/{name}.csv") for name in frequencies}
        for kind in ("features", "estimates")
    )
    return RouteTables(features, estimates)


def main(oscillator, frequencies_hz, levels_m, numerics, results, published):
    system = oscillator_from(oscillator)
    k_over_m, decimals = system.k / system.m, numerics["k_over_m_decimals"]
    setting = Setting(
        oscillator=system,
        frequencies_hz=frequencies_hz,
        levels_m=tuple(levels_m),
        scheme=numerics["scheme"],
        step_s=numerics["step_s"],
        k_over_m=k_over_m if decimals is None else round(k_over_m, decimals),
    )
    exact, as_published = (
        read_route(results, route, frequencies_hz) for route in ("exact", "as_published")
    )
    return claims_table(read_published(Path(published)), setting, exact, as_published)


if __name__ == "__main__":
    p = snakemake.params
    table = main(p.oscillator, p.frequencies_hz, p.levels_m, p.numerics, p.results, p.published)
    write_csv(snakemake.output.csv, table)
    write_text(snakemake.output.md, claims_markdown(table))
