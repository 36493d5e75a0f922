"""The page of a case."""

from pathlib import Path

from dampbalance.project.case import Case
from dampbalance.project.files import read_csv, write_text
from dampbalance.publishing.page.report import PageContent, report_page
from dampbalance.replication.numbers import by_key, with_claims
from dampbalance.studies.reading_study import read_study


def read_texts(files):
    return [Path(file).read_text(encoding="utf-8") for file in files]


if __name__ == "__main__":
    i, p = snakemake.input, snakemake.params
    claims = read_csv(i.claims, dtype=str) if i.claims else None
    numbers = read_csv(i.numbers)
    content = PageContent(
        case=Case.from_config(p.config),
        config=p.config,
        numbers=by_key(numbers if claims is None else with_claims(numbers, claims)),
        claims=claims,
        figures=dict(zip(p.figures, read_texts(i.figures), strict=True)),
        derived=dict(read_csv(i.derived, dtype=str)[["id", "value"]].to_numpy())
        if i.derived
        else {},
        studies=list(
            zip(map(read_study, i.study_files, p.papers), read_texts(i.study_figures), strict=True)
        ),
        study_folder=p.study_folder,
    )
    write_text(snakemake.output.page, report_page(content, p.page))
