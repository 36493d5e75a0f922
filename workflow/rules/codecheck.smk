# The outputs that codecheck.yml names, and a report of what came out of them. It names those of the case of the paper: no
# other case has this.
from dampbalance.publishing.codecheck import read as read_codecheck

CODECHECK = "codecheck.yml"
CODECHECK_SCHEMA = str(ROOT / "workflow/schemas/codecheck.schema.yaml")
CODECHECKED = []

if config["published"] and Path(CODECHECK).is_file():
    try:
        named = [item["file"] for item in read_codecheck(CODECHECK, CODECHECK_SCHEMA)["manifest"]]
    except ConfigurationError as error:
        raise WorkflowError(str(error)) from None
    if all(Path(file).is_relative_to(RESULTS) for file in named):
        CODECHECKED = named

if CODECHECKED:

    rule codecheck:
        input:
            configuration=CODECHECK,
            schema=CODECHECK_SCHEMA,
            claims=rules.claims.output.csv,
            outputs=CODECHECKED,
            modules=script_modules("codecheck/codecheck.py"),
        output:
            report=report(
                f"{RESULTS}/codecheck/report.md",
                caption="../report/codecheck.rst",
                category="Verdicts",
                labels={"result": "What a codechecker compares"},
            ),
        message:
            "Report for a CODECHECK"
        script:
            "../scripts/codecheck/codecheck.py"
