# The outputs that codecheck.yml names, and a report of what came out of them. It names those of the case of the paper: no
# other case has this.
from dampbalance.publishing.codecheck import read as read_codecheck

CODECHECKED = []

if config["published"]:
    try:
        checked = read_codecheck(
            project_file("codecheck.yml"),
            project_file("workflow/schemas/codecheck.schema.yaml"),
        )
    except ConfigurationError as error:
        raise WorkflowError(str(error)) from None
    named = [item["file"] for item in checked["manifest"]]
    if all(Path(file).is_relative_to(RESULTS) for file in named):
        CODECHECKED = named

if CODECHECKED:

    rule codecheck:
        input:
            configuration=project_file("codecheck.yml"),
            schema=project_file("workflow/schemas/codecheck.schema.yaml"),
            claims=rules.claims.output.csv,
            outputs=CODECHECKED,
            template=project_file("src/dampbalance/publishing/templates/codecheck.md.j2"),
            modules=script_modules("codecheck/codecheck.py"),
        output:
            report=report(
                f"{RESULTS}/codecheck/report.md",
                caption="../report/codecheck.rst",
                category="Verdicts",
                labels={"result": "What a codechecker compares"},
            ),
        log:
            log_file("codecheck"),
        conda:
            ENVIRONMENT
        params:
            top=".",
        message:
            "Report for a CODECHECK"
        script:
            "../scripts/codecheck/codecheck.py"
