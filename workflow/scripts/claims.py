"""A verdict on every printed number, as CSV and Markdown."""

from pathlib import Path

from dampbalance.claims import Route, Setting, claims_markdown, claims_table, read_published
from dampbalance.configuration import oscillator_from
from dampbalance.files import read_csv, write_csv, write_text


def main(config, results, published):
    frequencies = config["excitation"]["frequencies_hz"]
    numerics = config["as_published"]
    oscillator = oscillator_from(config["oscillator"])
    setting = Setting(
        oscillator=oscillator,
        frequencies_hz=frequencies,
        levels_m=tuple(config["excitation"]["levels_m"]),
        scheme=numerics["scheme"],
        step_s=numerics["step_s"],
        k_over_m=round(oscillator.k / oscillator.m, numerics["k_over_m_decimals"]),
    )
    exact, as_published = (
        Route(
            *(
                {name: read_csv(f"{results}/{kind}/{route}/{name}.csv") for name in frequencies}
                for kind in ("features", "estimates")
            )
        )
        for route in ("exact", "as_published")
    )
    return claims_table(read_published(Path(published)), setting, exact, as_published)


if __name__ == "__main__":
    p = snakemake.params
    table = main(p.config, p.results, p.published)
    write_csv(snakemake.output.csv, table)
    write_text(snakemake.output.md, claims_markdown(table))
