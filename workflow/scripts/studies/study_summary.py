"""Write what a study shows: a table of errors, and a page with the figure and its numbers in words."""

from pathlib import Path

from dampbalance.project.files import STATISTICAL_DIGITS, write_csv, write_text
from dampbalance.studies import reading_study
from dampbalance.studies.shown import summary
from dampbalance.studies.shown.paragraph import paragraph

if __name__ == "__main__":
    i, o, p = (getattr(snakemake, name) for name in ("input", "output", "params"))
    study, cases = reading_study.read_study(i.file, p.paper), i.cases
    table = summary.summary_of(cases, study)
    figure = next((Path(file).name for file in i.figure if file.endswith(".png")), "")
    text, _ = paragraph(study, cases)
    page = summary.summary_markdown(study, table, text, figure)
    write_csv(o.csv, table, STATISTICAL_DIGITS)
    write_text(o.md, page)
