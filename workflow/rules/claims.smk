# One table of the numbers of all routes; a verdict on every printed number; the comparison with the verdicts on record.

import time

PUBLISHED = project_file(config["published"]) if config["published"] else None
SUMMARY = Path(RESULTS, "summary.txt")

if PUBLISHED:  # slow to import
    from dampbalance.replication.claims import printed
    from dampbalance.replication.claims.rules import check_printed
    from dampbalance.replication.claims.table import WORSE, read_record

if PUBLISHED and workflow.is_main_process:
    names, levels = printed.FREQUENCIES, printed.LEVELS
    wrong = {
        "is not a folder with printed numbers and verdicts.csv": (
            not Path(PUBLISHED, "verdicts.csv").is_file()
        ),
        f"has numbers for {levels} levels at {', '.join(names)}, in this order": (
            (tuple(FREQUENCIES[: len(names)]), len(CASE.levels_m)) != (names, levels)
        ),
        "has t_s cut off: set as_published.tabulated.t_s_unit_s": (
            CASE.numerics.tabulated.get("t_s_unit_s") is None
        ),
    }
    where = (
        f"{CONFIG_FILES[-1] if CONFIG_FILES else 'configuration'}: published: {config['published']}"
    )
    for text, is_so in wrong.items():
        if is_so:
            raise WorkflowError(
                f"{where} {text}; use null for a case of your own, with nothing printed to compare with."
            )
    try:
        check_printed(printed.read_published(Path(PUBLISHED)))
        read_record(Path(PUBLISHED, "verdicts.csv"))
    except ValueError as error:
        raise WorkflowError(f"{where}/{error}.") from None


def published_files(wildcards):
    """Return the files of printed numbers, without the verdicts on record, which only the check reads."""
    return [f"{PUBLISHED}/printed.csv"]


def compared_at():
    """Return the time of the last comparison of verdicts, ns; None if there was none."""
    return SUMMARY.stat().st_mtime_ns if SUMMARY.is_file() else None


COMPARED_BEFORE = compared_at()


def rerun_while_worse(wildcards):
    """Return None if the last comparison passed; otherwise the time, so that `check` runs again."""
    worse = SUMMARY.is_file() and WORSE in SUMMARY.read_text(encoding="utf-8")
    return time.time_ns() if worse else None


rule numbers:
    input:
        features=of_routes("features"),
        estimates=of_routes("estimates"),
        unrounded=rules.response_as_published.output.unrounded,
        published=published_files if config["published"] else [],
        code=rooms("replication"),
    output:
        csv=f"{RESULTS}/numbers.csv",
    priority: FIRST
    params:
        case=of_case("oscillator", "frequencies_hz", "pairs"),
        folder=lambda wildcards: RESULTS,
        published=PUBLISHED,
    message:
        "Numbers of all routes"
    script:
        "../scripts/claims/numbers.py"


rule claims:
    input:
        numbers=rules.numbers.output.csv,
        published=published_files,
        code=rooms("replication"),
    output:
        csv=report(
            f"{RESULTS}/claims.csv",
            category="Verdicts",
            labels={"result": "Every printed number, its verdict and the reason"},
        ),
        md=f"{RESULTS}/claims.md",
    priority: FIRST
    params:
        case=of_case("oscillator", "frequencies_hz", "levels_m", "numerics"),
        published=PUBLISHED,
    message:
        "Verdicts on the printed numbers"
    script:
        "../scripts/claims/claims.py"


# This job never fails, so that everything else is built; the run fails at its end instead (onsuccess in the Snakefile).
rule check:
    input:
        claims=rules.claims.output.csv,
        recorded=f"{PUBLISHED}/verdicts.csv",
        code=rooms("replication"),
    output:
        summary=report(
            f"{RESULTS}/summary.txt",
            category="Verdicts",
            labels={"result": "How many numbers earn which verdict"},
        ),
    priority: FIRST
    params:
        again=rerun_while_worse,
    message:
        "Comparison with the verdicts on record"
    script:
        "../scripts/claims/check.py"
