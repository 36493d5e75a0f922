"""The cases and figures of several small studies."""

from dampbalance import __version__
from dampbalance.figures.style import save
from dampbalance.project.troubles import brief_troubles
from dampbalance.studies import case_files, evaluate, reading_study
from dampbalance.studies.shown.study_figure import alternative_text, study_figure

if __name__ == "__main__":
    brief_troubles(snakemake.log)
    p, o = snakemake.params, snakemake.output
    for file, cases, manifest, svg, png in zip(
        snakemake.input.files, o.cases, o.manifests, o.svg, o.png, strict=True
    ):
        study = reading_study.read_study(file, p.base)
        parts = evaluate.in_parts(study, 0, study.cases, threads=snakemake.threads)
        case_files.write_parts(cases, parts, study, __version__)
        case_files.write_manifest(manifest, cases, study, __version__)
        save(study_figure(study, cases), svg, png, alternative_text(study))
