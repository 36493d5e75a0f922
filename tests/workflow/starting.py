"""Snakemake, started many times, each time as a fork of a process that has imported what is slow to import.
The tests of interruptions, paths and SLURM start it as a user does."""

from __future__ import annotations

import gc
import os
import subprocess
import sys
import tempfile
from multiprocessing import forkserver, get_context
from pathlib import Path
from unittest.mock import patch

SERVER = get_context("forkserver")
SERVER.set_forkserver_preload(["preloaded"])


def snakemake(
    folder: Path, *arguments: str, project: Path | None = None
) -> subprocess.CompletedProcess:
    """What `snakemake` with these arguments says in a folder.

    project : the copy of the project whose package it uses, if that is not the folder.
    """
    with patch.dict(
        os.environ, PYTHONPATH=str(Path(__file__).parent)
    ):  # the server looks nowhere else
        forkserver.ensure_running()
    with tempfile.TemporaryDirectory() as said:
        process = SERVER.Process(target=_run, args=(folder, project or folder, arguments, said))
        process.start()
        process.join()
        out, err = (Path(said, name).read_text(encoding="utf-8") for name in ("out", "err"))
    return subprocess.CompletedProcess(arguments, process.exitcode, out, err)


def _run(folder: Path, project: Path, arguments: tuple[str, ...], said: str) -> None:
    gc.freeze()  # what was imported is no garbage
    for descriptor, name in ((1, "out"), (2, "err")):
        file = os.open(f"{said}/{name}", os.O_WRONLY | os.O_CREAT)
        os.dup2(file, descriptor)
    os.chdir(folder)
    os.environ["PYTHONPATH"] = str(project / "src")  # of the scripts
    sys.path.insert(0, str(project / "src"))
    sys.argv = ["snakemake", *arguments]
    from snakemake.cli import main

    main()
