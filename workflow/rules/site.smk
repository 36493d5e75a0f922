# The site of documentation: the project's texts, docstrings, schemas and commands, with all studies and what there is to
# read of the paper. Not a part of `all`: it needs every study.

SITE_SOURCES = (
    *(
        "CHANGELOG.md",
        "CITATION.cff",
        "CONTRIBUTING.md",
        "LICENSE",
        "README.md",
        "results/README.md",
    ),
    *("config", "examples", "paper", "src", "workflow"),
    *("tests/analytic/README.md", "trials/benchmarks", "trials/blind"),
)

# It shows the project as it lies there, whose folder must be that of the results, and the paper's case.
if config["published"] and Path.cwd() == ROOT and CASE.name == "paper":

    rule site:
        input:
            sources=files_of(ROOT, SITE_SOURCES),
            studies=expand(rules.study.output.md, study=STUDY_FILES),  # and so their figures
            paper=[rules.page.output.page, rules.article.output.pdf, rules.notebook.output.ipynb],
        output:
            site=directory("results/site"),
        message:
            "The site of documentation"
        script:
            "../scripts/site/site.py"
