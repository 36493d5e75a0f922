"""The figure of a study."""

from dampbalance.figures.style import save
from dampbalance.studies import reading_study
from dampbalance.studies.shown.study_figure import alternative_text, study_figure

if __name__ == "__main__":
    i, o, p = (getattr(snakemake, name) for name in ("input", "output", "params"))
    study = reading_study.read_study(i.file, p.paper)
    save(study_figure(study, i.cases), o.svg, o.png, alternative_text(study))
