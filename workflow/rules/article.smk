# The replication article: the numbers that no other result holds, its figures, and the PDF, which reads every number from
# the result files itself. Only a case with printed numbers to compare with has one.

ARTICLE_STUDIES = (
    "frequency level contact_stiffness damping read_out step_size rigid_contact map".split()
)
ARTICLE_PACKAGES = "dampbalance numpy scipy numba pandas matplotlib snakemake typst".split()
ARTICLE_FIGURES = "figure1 figure2 figure3 numerics glance estimation_error".split()


if config["published"]:

    rule article_numbers:
        input:
            numbers=rules.numbers.output.csv,
            claims=rules.claims.output.csv,
            steps=f"{STUDY_RESULTS}/step_size/cases.parquet",
            study_cases=expand(rules.study.output.cases, study=ARTICLE_STUDIES),
            study_files=[*map(STUDY_FILES.get, ARTICLE_STUDIES)],
            study_texts=study_texts(ARTICLE_STUDIES),
            rivals=[f"{PUBLISHED}/{name}.csv" for name in ("schemes", "cycles")],
            citation=project_file("CITATION.cff"),
            code=PACKAGE,
        output:
            **figure_files("numerics", "How the printed digits arose"),
            **figure_files("glance", "The findings at a glance"),
            derived=f"{RESULTS}/derived.csv",
        priority: NEXT
        params:
            papers=lambda wildcards: [STUDY_PLANS[name][2] for name in ARTICLE_STUDIES],
            case=of_case("oscillator", "frequencies_hz", "levels_m", "pairs", "phase", "numerics"),
            frequency=FREQUENCIES[0],
            packages=ARTICLE_PACKAGES,
        message:
            "Article: its numbers and figures"
        script:
            "../scripts/article/article_numbers.py"

    # The files that the article reads its numbers from, in the order of its list of sources, and the rule that makes each.
    ARTICLE_SOURCES = {
        f"{RESULTS}/derived.csv": "article_numbers",
        f"{RESULTS}/numbers.csv": "numbers",
        f"{RESULTS}/claims.csv": "claims",
    }

    rule article:
        input:
            texts=[project_file(file) for file in sorted((ROOT / "paper/article").rglob("*.typ"))],
            references=project_file("paper/article/references.yml"),
            sources=list(ARTICLE_SOURCES),
            figures=expand(f"{RESULTS}/figures/{{name}}.svg", name=ARTICLE_FIGURES),
            study_figures=expand(
                f"{STUDY_RESULTS}/{{study}}/figure.svg",
                study=("frequency", "rigid_contact", "map"),
            ),
            code=PACKAGE,
        output:
            pdf=report(
                f"{RESULTS}/article.pdf",
                category="Reading",
                labels={"result": "The article"},
            ),
        params:
            folder=lambda wildcards: project_file("paper/article"),
            results=lambda wildcards: "results",
            inputs={
                "results": RESULTS,
                "studies": STUDY_RESULTS,
                "sources": ARTICLE_SOURCES,
            },
        message:
            "Article: PDF"
        script:
            "../scripts/article/article.py"
