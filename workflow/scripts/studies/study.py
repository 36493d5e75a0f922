"""A study, as far as its rule asks for it: all cases in one file, from its chunks if it has any, and what they are; its
figure; a table of its errors, and a page with the figure and its numbers in words."""

from dampbalance import __version__
from dampbalance.figures.style import save
from dampbalance.project.files import STATISTICAL_DIGITS, write_csv, write_text
from dampbalance.studies import case_files, evaluate, reading_study
from dampbalance.studies.shown import summary
from dampbalance.studies.shown.paragraph import paragraph
from dampbalance.studies.shown.study_figure import alternative_text, study_figure

if __name__ == "__main__":
    i, o, p = (getattr(snakemake, name) for name in ("input", "output", "params"))
    study, cases = reading_study.read_study(p.file, p.paper), o.get("cases", i.get("cases"))
    if chunks := i.get("chunks"):
        case_files.join_chunks(cases, chunks, study)
    elif o.get("manifest"):
        parts = evaluate.in_parts(study, 0, study.cases, threads=snakemake.threads)
        case_files.write_parts(cases, parts, study, __version__)
    if o.get("manifest"):
        case_files.write_manifest(o.manifest, cases, study, __version__)
    if o.get("svg"):
        save(study_figure(study, cases), o.svg, o.png, alternative_text(study))
    if o.get("md"):
        table = summary.summary_of(cases, study)
        text, _ = paragraph(study, cases)
        figure = "figure.png" if study.figure else ""
        write_csv(o.csv, table, STATISTICAL_DIGITS)
        write_text(o.md, summary.summary_markdown(study, table, text, figure))
