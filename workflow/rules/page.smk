# The page that shows a case to people who read.
#
# A case with nothing printed to compare with gets a page without verdicts and studies: snakemake page --configfile …

PAGE_STUDIES = "frequency level damping contact_stiffness rigid_contact read_out step_size".split()
PAGE_FIGURES = ["figure3", "estimation_error"]
if config["published"]:
    PAGE_FIGURES += ["glance", "numerics"]
else:
    PAGE_STUDIES = []


rule page:
    input:
        claims=f"{RESULTS}/claims.csv" if config["published"] else [],
        numbers=rules.numbers.output.csv,
        figures=expand(f"{RESULTS}/figures/{{name}}.svg", name=PAGE_FIGURES),
        derived=rules.article_numbers.output.derived if config["published"] else [],
        study_files=[*map(STUDY_FILES.get, PAGE_STUDIES)],
        study_figures=expand(f"{STUDY_RESULTS}/{{study}}/figure.svg", study=PAGE_STUDIES),
        code=PACKAGE,
    output:
        page=report(
            f"{RESULTS}/report.html",
            category="Reading",
            labels={"result": "The page of the case"},
        ),
    params:
        papers=lambda wildcards: [STUDY_PLANS[name][2] for name in PAGE_STUDIES],
        config=config,
        study_folder=lambda wildcards: STUDY_RESULTS,
        figures=PAGE_FIGURES,
        page=lambda wildcards: f"{RESULTS}/report.html",
    message:
        "The page of the case"
    script:
        "../scripts/page/page.py"
