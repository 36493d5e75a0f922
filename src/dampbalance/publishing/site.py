"""Build the site of documentation by Sphinx: pages and settings are in paper/site.

Pages include texts and results of the project, and show what commands print. Sphinx runs in a separate process, on a
copy of the pages, next to which commands write; any warning that it gives is an error. The same project gives the same
bytes in any folder.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from ..project.files import UNFINISHED
from .notebook import run_notebook, write_notebook

PAGES = "paper/site"
REPORT_PAGE, TOUR = "results/paper/report.html", "results/paper/notebook/tour.ipynb"
GALLERY = "gallery"
"""The folder of pages that are notebooks, written as scripts and run here."""
PREPARED = ("case", "joint", "symptoms", "decay", "pendulum", "example")
"""Folders in which pages run commands. One that paper/site has is copied, and its lab.py writes the records."""

_LOCAL_LINK = re.compile(r"""(?<=<a)([^>]*?)\shref="(?![a-z]+:|#)[^"]*"(?=[^>]*>)""")


class SiteError(ValueError):
    """The site cannot be built; the message says what Sphinx or a program of a page complains about."""


def build_site(root: str | Path, target: str | Path) -> None:
    """Build the site of the project in the folder `root` into the folder `target`, which is replaced.

    The results of the paper and of all studies must be there. Raises SiteError for any warning of Sphinx.
    """
    root, target = Path(root).resolve(), Path(target).resolve()
    # The stage is as deep as paper/site: relative paths from the pages to files of the project hold in it, too.
    with tempfile.TemporaryDirectory(dir=root / "results", prefix=f"{UNFINISHED}site-") as folder:
        stage = Path(folder)
        shutil.copytree(root / PAGES, stage, dirs_exist_ok=True)
        shutil.copy(root / TOUR, stage / "explain")
        report = (root / REPORT_PAGE).read_text(encoding="utf-8")
        (stage / "extra/files").mkdir(parents=True)
        # The copy stands alone: links to files next to the original become plain text.
        (stage / "extra/files/report.html").write_text(_LOCAL_LINK.sub(r"\1", report), "utf-8")
        for place in PREPARED:
            run = stage / "extra/run" / place
            run.mkdir(parents=True)
            if (stage / place).is_dir():
                shutil.copytree(stage / place, run, dirs_exist_ok=True)
                _run("lab.py", folder=run)
        for script in sorted((stage / GALLERY).glob("*.py")):
            text = write_notebook(run_notebook(script))
            script.with_suffix(".ipynb").write_text(text, encoding="utf-8")
        flags = ["-b", "html", "-W", "--keep-going", "-n", "-q", "-d", f"{folder}/trees"]
        _run("-m", "sphinx", *flags, folder, f"{folder}/made", folder=root)
        (stage / "made/.buildinfo").unlink()  # serves only another run of Sphinx in this folder
        shutil.rmtree(target, ignore_errors=True)
        shutil.copytree(stage / "made", target)


def _run(*arguments: str, folder: Path) -> None:
    """Run a program of this Python. Raises SiteError with its output where it fails."""
    bin_folder = str(Path(sys.executable).parent)
    done = subprocess.run(
        [sys.executable, *arguments],
        cwd=folder,
        env={
            **os.environ,
            "PATH": os.pathsep.join([bin_folder, os.environ.get("PATH", "")]),
            "PYTHONHASHSEED": "0",
            "SOURCE_DATE_EPOCH": "0",
            "COLUMNS": "80",  # characters of a command's help that a page shows without scrolling
        },
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode:
        raise SiteError(f"the site was not built:\n{done.stderr or done.stdout}")
