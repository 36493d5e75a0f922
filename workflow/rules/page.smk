# The page that shows a case to people who read, and the picture of its match that the README shows (as paper/figures/match.svg).
#
# The page shows the small studies of the paper's oscillator, seconds each, never the map over a million. A case of one's own,
# with nothing printed to compare with, gets a page without verdicts and studies: snakemake page --configfile …

PAGE_STUDIES = [
    *("frequency", "level", "damping", "contact_stiffness", "rigid_contact"),
    *("read_out", "step_size"),
]
PAGE_PARTS = sorted(
    project_input(path)
    for folder in ("static", "templates")
    for path in (ROOT / "src/dampbalance/publishing/page" / folder).iterdir()
)

# What tells how the printed digits arose.
PAGE_EVIDENCE = {}
if config["published"]:
    PAGE_EVIDENCE = {
        "exact": f"{RESULTS}/features/exact/{FREQUENCIES[0]}.csv",
        "as_published": f"{RESULTS}/estimates/as_published/{FREQUENCIES[0]}.csv",
        "schemes": rules.article_schemes.output.csv,
        "steps": f"{STUDY_RESULTS}/step_size/cases.parquet",
    }


rule page:
    input:
        **PAGE_EVIDENCE,
        claims=f"{RESULTS}/claims.csv" if config["published"] else [],
        tables=rules.tables.output.csv,
        orbits=f"{RESULTS}/orbits/{FREQUENCIES[0]}.json",
        estimates=expand(f"{RESULTS}/estimates/exact/{{frequency}}.csv", frequency=FREQUENCIES),
        study_files=study_files(PAGE_STUDIES) if config["published"] else [],
        study_cases=(
            expand(f"{STUDY_RESULTS}/{{study}}/cases.parquet", study=PAGE_STUDIES)
            if config["published"]
            else []
        ),
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
        **STUDY_DEFAULTS,
        config=config,
        folder=lambda wildcards: placed(RESULTS),
        page=lambda wildcards: f"{RESULTS}/report.html",
    message:
        "The page of the case"
    script:
        "../scripts/page/page.py"


rule match:
    input:
        claims=f"{RESULTS}/claims.csv",
        modules=script_modules("page/match.py"),
    output:
        picture=report(
            f"{RESULTS}/figures/match.svg",
            caption="../report/match.rst",
            category="Verdicts",
            labels={"result": "The match at a glance"},
        ),
    log:
        log_file("match"),
    conda:
        ENVIRONMENT
    message:
        "The picture of the match"
    script:
        "../scripts/page/match.py"
