# The printed numbers to compare with, and the time of the last comparison.
import time

PUBLISHED = project_file(config["published"]) if config["published"] else None

if PUBLISHED:  # slow to import
    from dampbalance.replication.claims.table import WORSE

if PUBLISHED and workflow.is_main_process:
    from dampbalance.replication.claims import print as printed
    from dampbalance.replication.claims.rules import check_printed
    from dampbalance.replication.claims.table import read_record

    file = CONFIG_FILES[-1] if CONFIG_FILES else "configuration"
    where = f"{file}: published: {config['published']}"
    other = "use null for a case of your own, with nothing printed to compare with"
    if not Path(PUBLISHED, "verdicts.csv").is_file():
        raise WorkflowError(
            f"{where} is not a folder with printed numbers and verdicts.csv; {other}."
        )
    of_the_paper = tuple(FREQUENCIES[: len(printed.FREQUENCIES)]) == printed.FREQUENCIES
    if not of_the_paper or len(CASE.levels_m) != printed.LEVELS:
        raise WorkflowError(
            f"{where} has numbers for {printed.LEVELS} levels at {', '.join(printed.FREQUENCIES)}, in this order; {other}."
        )
    if CASE.numerics.tabulated.get("t_s_unit_s") is None:
        raise WorkflowError(
            f"{where} has t_s cut off: set as_published.tabulated.t_s_unit_s; {other}."
        )
    try:
        check_printed(printed.read_published(Path(PUBLISHED)))
        read_record(Path(PUBLISHED, "verdicts.csv"))
    except ValueError as error:
        raise WorkflowError(f"{where}/{error}.") from None


def published_files(wildcards):
    """Return the files of printed numbers, without the verdicts on record, which only the check reads."""
    return [f"{PUBLISHED}/printed.csv"]


SUMMARY = Path(RESULTS, "summary.txt")


def compared_at():
    """Return the time of the last comparison of verdicts, ns; None if there was none."""
    return SUMMARY.stat().st_mtime_ns if SUMMARY.is_file() else None


COMPARED_BEFORE = compared_at()


def rerun_while_worse(wildcards):
    """Return None if the last comparison passed; otherwise the time, so that `check` runs again."""
    worse = SUMMARY.is_file() and WORSE in SUMMARY.read_text(encoding="utf-8")
    return time.time_ns() if worse else None
