"""The figure of a study."""

from dampbalance.figures.style import save
from dampbalance.project.troubles import brief_troubles
from dampbalance.studies import checking
from dampbalance.studies.shown.study_figure import alternative_text, study_figure

if __name__ == "__main__":
    brief_troubles(snakemake.log)
    study = checking.read_study(
        snakemake.input.file, snakemake.params.schema, snakemake.params.base
    )
    figure = study_figure(study, snakemake.input.cases)
    save(figure, snakemake.output.svg, snakemake.output.png, alternative_text(study))
