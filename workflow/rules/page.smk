# The page that shows a case to people who read.
#
# The page shows the small studies of the paper's oscillator, seconds each, never the map over a million. A user's case,
# with nothing printed to compare with, gets a page without verdicts and studies: snakemake page --configfile …

PAGE_PARTS = sorted(
    project_file(path)
    for folder in ("static", "templates")
    for path in (ROOT / "src/dampbalance/publishing/page" / folder).iterdir()
)

PAGE_STUDIES = [*SMALL_STUDIES, "noise"] if config["published"] else []
PAGE_FIGURES = {
    name: f"{RESULTS}/figures/{name}.svg"
    for name in [
        "figure3",
        "estimation_error",
        *(["glance", "numerics"] if config["published"] else []),
    ]
}


rule page:
    input:
        claims=f"{RESULTS}/claims.csv" if config["published"] else [],
        tables=rules.tables.output.csv,
        figures=list(PAGE_FIGURES.values()),
        evidence=rules.article_numbers.output.evidence if config["published"] else [],
        shown=rules.article_numbers.output.studies if config["published"] else [],
        noise=f"{STUDY_RESULTS}/noise/summary.csv" if "noise" in PAGE_STUDIES else [],
        study_files=study_files(PAGE_STUDIES),
        study_figures=expand(f"{STUDY_RESULTS}/{{study}}/figure.svg", study=PAGE_STUDIES),
        parts=PAGE_PARTS,
        modules=script_modules("page/page.py"),
    output:
        page=report(
            f"{RESULTS}/report.html",
            caption="../report/page.rst",
            category="Reading",
            labels={"result": "The page of the case"},
        ),
    log:
        log_file("page"),
    benchmark:
        log_file("page", "tsv")
    conda:
        ENVIRONMENT
    params:
        base=BASE_CONFIG,
        config=config,
        figures=list(PAGE_FIGURES),
        folder=lambda wildcards: RESULTS,
        page=lambda wildcards: f"{RESULTS}/report.html",
    message:
        "The page of the case"
    script:
        "../scripts/page/page.py"
