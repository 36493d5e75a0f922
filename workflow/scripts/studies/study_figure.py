"""The figures of one or several studies."""

from dampbalance.figures.style import save
from dampbalance.project.troubles import brief_troubles
from dampbalance.studies import checking
from dampbalance.studies.shown.study_figure import alternative_text, study_figure

if __name__ == "__main__":
    brief_troubles(snakemake.log)
    i, o, p = (getattr(snakemake, name) for name in ("input", "output", "params"))
    for cases, file, svg, png in zip(i.cases, i.files, o.svg, o.png, strict=True):
        study = checking.read_study(file, p.schema, p.base)
        save(study_figure(study, cases), svg, png, alternative_text(study))
