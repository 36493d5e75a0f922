"""Start Snakemake in this folder, once it is clear that it can run there.

    python workflow/run.py --cores all [any argument of Snakemake]

`make` starts its runs through this. What Snakemake answers with a traceback or not at all is told in one sentence,
before anything is touched: a configuration file that cannot be read, a folder that cannot be written, a full disk,
another run in the same folder. What an interrupted run left is put right: its lock is lifted, and what it had not
finished is made again.
"""

from __future__ import annotations

import os
import shutil
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from time import time

import psutil
from forks import scripts_as_forks

from dampbalance.project.documents import ConfigurationError, read_yaml
from dampbalance.project.files import remove_unfinished
from dampbalance.project.progress import FOLDER

RESULTS, STATE = Path("results"), Path(".snakemake")
PROFILE = "workflow/profiles/default"
CACHED = [
    "study_chunk"
]  # rules whose results are kept in the folder that SNAKEMAKE_OUTPUT_CACHE names
LEAST_FREE = 100e6  # bytes: the results of the paper's case and of the noise study take 70 MB


def configuration_files(arguments: list[str]) -> list[str]:
    """The file that every run reads, and those that the arguments name."""
    files, named = ["config/config.yaml"], False
    for argument in arguments:
        option, _, value = argument.partition("=")
        if option in ("--configfile", "--configfiles"):
            named = not value
            files += [value] if value else []
        elif argument.startswith("-"):
            named = False
        elif named:
            files.append(argument)
    return files


def unwritable() -> Iterator[Path]:
    """Folders that a run writes into and may not."""
    for top in (RESULTS, STATE):
        folders = (Path(folder) for folder, _, _ in os.walk(top)) if top.exists() else [Path()]
        yield from (folder for folder in folders if not os.access(folder, os.W_OK | os.X_OK))


def other_run() -> psutil.Process | None:
    """A run in this folder that is alive: Snakemake, a job that outlived it, or one that began before this."""
    here, this = Path.cwd(), psutil.Process()
    own = {this.pid, *(parent.pid for parent in this.parents())}
    for process in psutil.process_iter(["cmdline", "cwd"]):
        words = process.info["cmdline"] or []
        if process.pid in own or process.info["cwd"] != str(here) or {"-n", "--dry-run"} & {*words}:
            continue
        script = _script(words)
        runs = Path(script).name == "snakemake" or ".snakemake/scripts/" in script
        if runs or (script.endswith("workflow/run.py") and _age(process) < _age(this)):
            return process
    return None


def _script(words: list[str]) -> str:
    """The script or module that a command line has Python run; "" for any other program, such as an editor or `man`."""
    python, *rest = words or [""]
    names = (word for word in rest if not word.startswith("-"))
    return next(names, "") if Path(python).name.startswith("python") else ""


def _age(process: psutil.Process) -> tuple[float, int]:
    return process.create_time(), process.pid


def obstacle(arguments: list[str]) -> str:
    """Why Snakemake cannot run here, and what to do; "" if it can."""
    try:
        for file in configuration_files(arguments):
            read_yaml(file)
    except ConfigurationError as error:
        return str(error)
    for folder in unwritable():
        return f"{folder.resolve()} cannot be written: give yourself the right to, or build in a copy of the project"
    if (free := shutil.disk_usage(Path()).free) < LEAST_FREE:
        return f"{free / 1e6:.0f} MB are free on this disk and {LEAST_FREE / 1e6:.0f} are needed: make room first"
    if other := other_run():
        since = f"process {other.pid}, for {(time() - other.create_time()) / 60:.0f} minutes"
        return f"another run is at work in this folder ({since}): wait for it, or end it with kill {other.pid}"
    return ""


def main(arguments: list[str]) -> None:
    """Look, clear away, and run Snakemake."""
    if problem := obstacle(arguments):
        sys.exit(f"error: {problem}")
    # slow to import
    from snakemake.cli import args_to_api, parse_args
    from snakemake.exceptions import print_exception

    if (STATE / "locks").exists():
        print(
            "The last run was interrupted: its lock is lifted, and what it had not finished is made again.",
            flush=True,
        )
        shutil.rmtree(STATE / "locks")  # as --unlock does
        remove_unfinished(RESULTS)
    given = ["--workflow-profile", PROFILE, *arguments]
    if os.environ.get("SNAKEMAKE_OUTPUT_CACHE"):
        given = ["--cache", *CACHED, *given]
    if sys.stderr.isatty():
        import terminal
        from snakemake_interface_logger_plugins.registry import LoggerPluginRegistry

        LoggerPluginRegistry().register_plugin("snakemake_logger_plugin_terminal", terminal)
        given += ["--logger=terminal"]
    with tempfile.TemporaryDirectory() as folder:
        os.environ[FOLDER] = folder
        try:
            parser, settings = parse_args(given)
            settings.max_jobs_per_timespan = (
                None  # a limit makes it look at all jobs each second, more and more often
            )
            with scripts_as_forks():
                done = args_to_api(settings, parser)
        except Exception as error:  # as Snakemake's own `main`
            print_exception(error)
            done = False
    sys.exit(not done)


if __name__ == "__main__":
    main(sys.argv[1:])
